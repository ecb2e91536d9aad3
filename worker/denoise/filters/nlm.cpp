// SPDX-License-Identifier: Apache-2.0
// NL-means of colour alone: of two halves (Rousselle et al. 2012), or channel by channel.
#include "worker/denoise/filters/nlm.h"

#include <limits>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

NlmTuning tuning(const FilterPlan& p) {
  return {.k = p["k"], .alpha = p["alpha"], .threshold = p["threshold"], .epsilon = p["epsilon"]};
}

bool by_exponentials(const FilterPlan& p) {
  return p.is("mode", "prefilter") && p.is("patch_mode", "mean_of_exp");
}

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const NlmShape shape = nlm_shape(plan.parameters);
  const int images = 3 / shape.channels;
  const Planes valid = s.planes(1, std::numeric_limits<float>::infinity());
  const Planes signal = s.planes(images * 2 * shape.halves * shape.channels),
               result = s.planes(3 * shape.halves);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), valid, signal, s.layout(),
        by_exponentials(plan) ? cl_float2{{1, static_cast<float>(0.5 * plan["epsilon"])}}
                              : nlm_variance(tuning(plan)));
  Nlm nlm(s, s.region(0), shape);
  for (int i = 0; i < images; ++i)
    if (by_exponentials(plan))
      nlm.mean_of_exp(valid, signal, 2 * i, result, i);
    else
      nlm.run(valid, signal, 2 * i, result, i, tuning(plan));
  s.run("finish", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), valid, result, s.layout(),
        Exactly{s.inner()}, s.output());
}

std::string options(const FilterPlan& plan) {
  return nlm_options(nlm_shape(plan.parameters), plan.is("cut", "soft"));
}

}  // namespace

Program nlm_program() {
  return {"nlm",
          {kernels::tiles_cl, kernels::nlm_common_cl, kernels::nlm_cl, kernels::nlm_prefilter_cl,
           kernels::nlm_filter_cl},
          options,
          run};
}

}  // namespace tessera
