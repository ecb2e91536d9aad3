// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/recipe.h"

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

const Recipe kRecipes[] = {
    {"atrous", kernels::atrous_cl, 6, 3, [](const FilterPlan&) { return std::string(); }, atrous_scalars},
};

}  // namespace

const Recipe& recipe_of(std::string_view filter) {
  for (const Recipe& r : kRecipes)
    if (r.name == filter) return r;
  assert(!"every filter with passes has a recipe");
  __builtin_unreachable();
}

}  // namespace tessera
