// SPDX-License-Identifier: Apache-2.0
// Robust denoising using feature and colour information (Rousselle et al. 2013): prefilter the features, run
// three filters, estimate their errors, blend them by smoothed choices.
#include <fmt/format.h>

#include "kernels.h"
#include "worker/denoise/filters/patches.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr int kOwnMaps = 4 * kOffsets + 24;  // of rdfc_candidates: distances and sums

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const auto value = [&](std::string_view name) { return static_cast<float>(plan[name]); };
  const float unit = plan["depth_scale"] > 0 ? value("depth_scale") : 1.0f;
  const Planes base = s.planes(7), raw = s.planes(21), features = s.planes(14), candidates = s.planes(9);
  const Planes& later = raw;  // the scales, then the errors: the raw features are no longer needed
  const Planes errors = s.planes(6);
  const Chunks chunks(s, kOwnMaps);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), 1 / unit, base, raw,
        s.layout());
  s.run("rdfc_features", chunks.over(s, s.region(0)), 1, base, raw, features, s.layout(), s.region(0),
        chunks.rows(), chunks.scratch());
  s.run("rdfc_scales", s.region(1), 1, base, features, later, s.layout(), s.region(1),
        cl_float4{{value("k_f") * value("k_f"), value("tau"), value("tau_features"), 0}});
  s.run("rdfc_candidates", chunks.over(s, s.region(1)), 1, base, features, later, candidates, errors,
        s.layout(), s.region(1), chunks.rows(), chunks.scratch(), static_cast<cl_int>(plan["window"]),
        value("k_c") * value("k_c"));
  const int taken = static_cast<int>(plan["take"]);  // 0: the best
  if (taken == 0) {
    s.run("rdfc_errors", chunks.over(s, s.region(2)), 1, base, errors, s.layout(), s.region(2), chunks.rows(),
          chunks.scratch());
    s.run("rdfc_blend", chunks.over(s, s.region(3)), 1, base, errors, candidates, s.layout(), s.region(3),
          chunks.rows(), chunks.scratch());
  }
  s.run("finish", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), base, candidates,
        taken == 0 ? 0 : 3 * (taken - 1), s.layout(), Exactly{s.inner()}, s.output());
}

std::string options(const FilterPlan&) {
  return fmt::format("-DOWN_MAPS={} -DPREFILTER_WINDOW={} -DERROR_WINDOW={} -DSELECTION_WINDOW={}", kOwnMaps,
                     5, 1, 5);
}

}  // namespace

Program rdfc_program() {
  return {"rdfc",
          {kernels::patches_cl, kernels::rdfc_features_cl, kernels::rdfc_cl, kernels::rdfc_select_cl},
          options,
          run};
}

}  // namespace tessera
