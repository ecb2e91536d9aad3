// SPDX-License-Identifier: Apache-2.0
// FDF (Lardinoije): smooth the shading, then filter by the features.
#include <fmt/format.h>

#include <limits>
#include <numbers>

#include "core/filter/pairs.h"
#include "kernels.h"
#include "worker/denoise/filters/nlm.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

int signals(const FilterPlan& plan) { return plan.is("guides", "prefiltered") ? 7 : 1; }

cl_float4 scales(const FilterPlan& p) {
  const auto scale = [](double most) { return static_cast<float>(kOctave * std::numbers::log2e / most); };
  return {{scale(p["t_max"]), scale(p["n_max"]), scale(p["s_max"]), 0}};
}

void run(Stage& s) {
  const FilterPlan plan = resolved(s.plan(), {});  // what no scene has said counts as 1
  const Planes valid = s.planes(1, std::numeric_limits<float>::infinity());
  const Planes guides = s.planes(8), signal = s.planes(2 * signals(plan));
  const Planes color = s.planes(3), result = s.planes(3);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), valid, guides, signal,
        color, s.layout(),
        cl_float2{{static_cast<float>(1 / plan["light"]), static_cast<float>(0.5 * plan["epsilon"])}});
  Nlm nlm(s, s.region(0), fdf_prefilter_shape(plan.parameters));
  for (int k = 0; k < signals(plan); ++k) nlm.mean_of_exp(valid, signal, 2 * k, guides, k == 0 ? 6 : k - 1);
  const PairShape shape{static_cast<int>(plan["radius"])};
  const Tiles parts = tiles(s, s.region(1), kPairColumns, kPairRows);
  const int room = pair_floats(shape, parts.columns, parts.rows, s.vector());
  s.run("fdf_filter", {0, 0, 1, parts.groups}, 1, valid, guides, color, result, s.layout(), s.region(1),
        parts.columns, parts.rows, s.scratch(static_cast<std::size_t>(parts.groups) * room), room,
        scales(plan));
  s.run("finish", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), valid, result, s.layout(),
        Exactly{s.inner()}, s.output());
}

std::string options(const FilterPlan& plan) {
  const PairShape shape{static_cast<int>(plan["radius"])};
  return fmt::format("{} -DPAIR_RADIUS={} -DPAIR_ROWS={} -DPAIR_GROUP={} -DFDF_SIGNALS={}",
                     nlm_options(fdf_prefilter_shape(plan.parameters)), shape.radius, shape.rows(),
                     kPairGroup, signals(plan));
}

}  // namespace

Program fdf_program() {
  return {"fdf",
          {kernels::tiles_cl, kernels::pairs_cl, kernels::nlm_common_cl, kernels::nlm_prefilter_cl,
           kernels::fdf_cl},
          options,
          run};
}

}  // namespace tessera
