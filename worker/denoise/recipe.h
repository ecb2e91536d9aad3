// SPDX-License-Identifier: Apache-2.0
// How a filter's description becomes kernels: its source, its planes, and the numbers each pass is given.
// Internal to worker/denoise.
#pragma once

#include "core/filter/filter.h"
#include "worker/denoise/device_cl.h"

namespace tessera {

struct Recipe {
  std::string_view name, source;
  int guide_planes, signal_planes;
  std::string (*options)(const FilterPlan&);  // for the kernel compiler
  cl_float4 (*scalars)(const FilterPlan&, const Pass&);
};

// Precondition: the filter has passes.
const Recipe& recipe_of(std::string_view filter);

}  // namespace tessera
