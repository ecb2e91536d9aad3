// SPDX-License-Identifier: Apache-2.0
// The Data Driven Filter (van de Vlasakker 2013).
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

constexpr double kPaperSamples = 8;

int planes(const FilterPlan& plan) {
  return 20 + plan.is("direction", "neighbours") + plan.is("progressive", "on");
}

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const Window w = window(s, planes(plan));
  // Depth itself is in its unit; what is left of the scale is its sigma's.
  const float tenths = depth_scale(plan, gaussian_scale(1)), direct = gaussian_scale(plan["sigma_dc"]),
              indirect = gaussian_scale(plan["sigma_ic"]);
  const cl_float4 units{{tenths, direct, indirect, static_cast<float>(1 / kPaperSamples)}};
  const double direction = plan["sigma_direction"];
  const cl_float8 stops{{gaussian_scale(plan["sigma_depth"]), gaussian_scale(plan["sigma_normal"]),
                         gaussian_scale(plan["sigma_texture"]), gaussian_scale(plan["sigma_texture2"]),
                         static_cast<float>(std::numbers::log2e / (2 * direction * direction)), 0, 0, 0}};
  const auto scale = [&](const char* name) { return static_cast<float>(plan[name]); };
  const cl_float8 scales{{scale("s_depth") * tenths * tenths, scale("s_normal"), scale("s_texture"),
                          scale("s_texture2"), scale("s_direction"), 0, 0, 0}};
  const cl_float2 unscale{{1 / direct, 1 / indirect}};
  s.run("prepare", w.to_prepare, 1, s.input(), s.outer().width(), s.outer().height(), w.strips,
        Exactly{s.inner()}, units, stops, scales);
  s.run("ddf", w.to_filter, 1, s.input(), s.outer().width(), s.outer().height(), w.strips, Exactly{s.inner()},
        unscale, s.output());
}

std::string options(const FilterPlan& plan) {
  return window_options(plan, planes(plan)) + (plan.is("progressive", "on") ? " -DPROGRESSIVE" : "");
}

}  // namespace

Program ddf_program() { return {"ddf", {kernels::window_cl, kernels::ddf_cl}, options, run}; }

}  // namespace tessera
