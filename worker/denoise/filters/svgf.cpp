// SPDX-License-Identifier: Apache-2.0
// SVGF (Schied et al. 2017) without history: demodulate, find the variance, five levels, modulate.
#include <fmt/format.h>

#include <limits>
#include <numbers>
#include <utility>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

// The kernels take exponents to base 2, hence ln 2. The tolerances keep divisions finite: 0.1 % of the depth,
// so that the interpolated depths of a surface seen along its iso-depth lines still agree, and a luminance
// far below any noise (Schied et al. 2017 name neither).
cl_float4 scalars(const FilterPlan& plan, const Pass& pass) {
  constexpr double kDepthTolerance = 1e-3, kLuminanceTolerance = 1e-10;
  const auto ln2_times = [](double v) { return static_cast<float>(std::numbers::ln2 * v); };
  return {{ln2_times(plan["sigma_z"] * pass.step), ln2_times(kDepthTolerance), ln2_times(plan["sigma_l"]),
           ln2_times(kLuminanceTolerance)}};
}

void run(Stage& s) {
  const Planes guides = s.planes(4, std::numeric_limits<float>::infinity());
  Planes from = s.planes(8), to = s.planes(8);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, from, s.layout());
  for (std::size_t i = 0; i < s.passes().size(); ++i, std::swap(from, to)) {
    const Pass& pass = s.passes()[i];
    s.run(std::string(pass.kernel).c_str(), s.region(i), pass.step, guides, from, to, s.layout(), s.region(i),
          pass.step, scalars(s.plan(), pass));
  }
  s.run("finish", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), guides, from, s.layout(),
        Exactly{s.inner()}, s.output());
}

// The parameter's choices are the powers of two in order.
std::string options(const FilterPlan& plan) { return fmt::format("-DSQUARINGS={}", plan["sigma_n"]); }

}  // namespace

Program svgf_program() { return {"svgf", {kernels::geometry_cl, kernels::svgf_cl}, options, run}; }

}  // namespace tessera
