// SPDX-License-Identifier: Apache-2.0
// The SURE-based a-trous filter (Kim et al. 2016): levels, then the details weighed and put back.
#include <fmt/format.h>

#include <limits>
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

// The illumination's deviation halves with every level (Kim et al.
// 2016, section 2.1), or is propagated; the others' double (Dammertz et al. 2010, section 3).
cl_float4 scalars(const FilterPlan& plan, int step) {
  constexpr double kLuminanceTolerance = 1e-10;  // far below any noise
  const double ln2 = std::numbers::ln2;
  const float light = plan.is("edge", "svgf") ? static_cast<float>(ln2 * plan["sigma_l"])
                                              : exponent_over_square(plan["sigma_y"] / step);
  const float distance = plan.is("distance", "depth") ? static_cast<float>(ln2 * plan["sigma_z"] * step)
                                                      : exponent_over_square(plan["sigma_x"] * step);
  return {{light, exponent_over_square(plan["sigma_n"] * step), distance,
           static_cast<float>(ln2 * kLuminanceTolerance)}};
}

// The variance of a level's detail propagates as if its input were not correlated. Of white noise that
// nothing stops, a level leaves squares, the sum of the kernel's squares; its detail has (1 - centre)^2 +
// squares - centre^2 of what came in, and truly the square of the deviation below.
float correction(int level) {
  constexpr double kDeviations[] = {0.89080, 0.20066, 0.08551, 0.04122, 0.02042};
  constexpr double kSquares = 35.0 / 128 * 35 / 128, kCentre = 9.0 / 64;
  double propagated = 1 - 2 * kCentre + kSquares;
  for (int i = 0; i < level; ++i) propagated *= kSquares;
  return static_cast<float>(kDeviations[level] * kDeviations[level] / propagated);
}

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const int levels = static_cast<int>(plan["levels"]);
  const int of_level = plan.is("edge", "svgf") ? 5 : 4;
  const Planes guides =
      s.planes(plan.is("distance", "depth") ? 4 : 6, std::numeric_limits<float>::infinity());
  const Planes pyramid = s.planes((levels + 1) * of_level);
  const Planes details = plan.is("mode", "literal") ? pyramid : s.planes(2 * levels);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, pyramid,
        s.layout());
  int level = 0;
  for (std::size_t i = 0; i < s.passes().size(); ++i) {
    const Pass& pass = s.passes()[i];
    if (pass.kernel == "sure_variance")
      s.run("sure_variance", s.region(i), 1, guides, pyramid, s.layout(), s.region(i), scalars(plan, 1));
    if (pass.kernel != "sure_level") continue;
    s.run("sure_level", s.region(i), pass.step, guides, pyramid, details, s.layout(), s.region(i), pass.step,
          level, correction(level), scalars(plan, pass.step));
    ++level;
  }
  for (level = 0; level < levels && !plan.is("mode", "literal"); ++level)
    s.run("sure_weights", s.inner(), 1 << level, guides, pyramid, details, s.layout(), s.inner(), 1 << level,
          level);
  s.run("sure_reconstruct", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), guides, pyramid,
        s.layout(), Exactly{s.inner()}, levels, s.output());
}

std::string options(const FilterPlan& plan) {
  const bool by_luminance = plan.is("edge", "svgf");
  return fmt::format(
      "-DBY_DEPTH={:d} -DBY_LUMINANCE={:d} -DLEVEL_PLANES={} -DLITERAL={:d} -DON_GRID={:d} -DWINDOW={}",
      plan.is("distance", "depth"), by_luminance, by_luminance ? 5 : 4, plan.is("mode", "literal"),
      plan.is("weights", "grid"), plan["window"]);
}

}  // namespace

Program sure_atrous_program() {
  return {"sure-atrous", {kernels::geometry_cl, kernels::sure_atrous_cl}, options, run};
}

}  // namespace tessera
