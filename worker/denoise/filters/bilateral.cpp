// SPDX-License-Identifier: Apache-2.0
// The bilateral filter and the cross-bilateral one, which differ in their planes only.
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

void run(Stage& s, int planes, const cl_float4& scales) {
  const Window w = window(s, planes);
  const FilterPlan& plan = s.plan();
  const double sigma_s = plan["sigma_s"] * (2 * s.passes().front().radius + 1);
  const cl_float near = static_cast<float>(kOctave * std::numbers::log2e / (2 * sigma_s * sigma_s));
  const cl_float unscale = 1 / scales.s[0];
  s.run("prepare", w.to_prepare, 1, s.input(), s.outer().width(), s.outer().height(), w.strips,
        Exactly{s.inner()}, scales);
  s.run("bilateral", w.to_filter, 1, s.input(), s.outer().width(), s.outer().height(), w.strips,
        Exactly{s.inner()}, near, unscale, s.output());
}

}  // namespace

Program bilateral_program() {
  return {"bilateral",
          {kernels::window_cl, kernels::bilateral_cl},
          [](const FilterPlan& plan) { return window_options(plan, 3); },
          [](Stage& s) {
            run(s, 3, {{gaussian_scale(s.plan()["sigma_r"]), 0, 0, 0}});
          }};
}

Program cross_bilateral_program() {
  return {"cross-bilateral",
          {kernels::window_cl, kernels::bilateral_cl},
          [](const FilterPlan& plan) { return window_options(plan, 10); },
          [](Stage& s) {
            const FilterPlan& plan = s.plan();
            run(s, 10,
                {{gaussian_scale(plan["sigma_r"]), depth_scale(plan, plan["sigma_d"]),
                  gaussian_scale(plan["sigma_n"]), gaussian_scale(plan["sigma_a"])}});
          }};
}

}  // namespace tessera
