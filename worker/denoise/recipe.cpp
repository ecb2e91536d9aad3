// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/recipe.h"

#include <fmt/format.h>

#include <cassert>
#include <numbers>

#include "kernels.h"

namespace tessera {
namespace {

float log2e_over_square(double sigma) { return static_cast<float>(std::numbers::log2e / (sigma * sigma)); }

// The colour's sigma halves with every level, the others double: Dammertz et al. 2010, section 3. The kernels
// take exponents to base 2.
cl_float4 atrous_scalars(const FilterPlan& plan, const Pass& pass) {
  return {{log2e_over_square(plan["sigma_c"] / pass.step), log2e_over_square(plan["sigma_n"] * pass.step),
           log2e_over_square(plan["sigma_x"] * pass.step), 0}};
}

// The kernels take exponents to base 2, hence ln 2. The tolerances keep divisions finite: 0.1 % of the depth,
// so that the interpolated depths of a surface seen along its iso-depth lines still agree, and a luminance
// far below any noise (Schied et al. 2017 name neither).
cl_float4 svgf_scalars(const FilterPlan& plan, const Pass& pass) {
  constexpr double kDepthTolerance = 1e-3, kLuminanceTolerance = 1e-10;
  const auto ln2_times = [](double v) { return static_cast<float>(std::numbers::ln2 * v); };
  return {{ln2_times(plan["sigma_z"] * pass.step), ln2_times(kDepthTolerance), ln2_times(plan["sigma_l"]),
           ln2_times(kLuminanceTolerance)}};
}

// The parameter's choices are the powers of two in order.
std::string svgf_options(const FilterPlan& plan) { return fmt::format("-DSQUARINGS={}", plan["sigma_n"]); }

const Recipe kRecipes[] = {
    {"atrous", kernels::atrous_cl, 6, 3, [](const FilterPlan&) { return std::string(); }, atrous_scalars},
    {"svgf", kernels::svgf_cl, 4, 8, svgf_options, svgf_scalars},
};

}  // namespace

const Recipe& recipe_of(std::string_view filter) {
  for (const Recipe& r : kRecipes)
    if (r.name == filter) return r;
  assert(!"every filter with passes has a recipe");
  __builtin_unreachable();
}

}  // namespace tessera
