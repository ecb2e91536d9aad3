// SPDX-License-Identifier: Apache-2.0
// The filters as programs for a device: the sources of their kernels, and what runs them. Internal to
// worker/denoise.
#pragma once

#include "worker/denoise/stage.h"

namespace tessera {

struct Program {
  std::string_view name;
  std::vector<std::string_view> sources;      // behind kernels/common.cl
  std::string (*options)(const FilterPlan&);  // for the kernel compiler
  void (*run)(Stage&);                        // until the kernels that fill output() are enqueued
};

Program atrous_program();
Program bilateral_program();
Program bmfr_program();
Program box_program();
Program cross_bilateral_program();
Program ddf_program();
Program gaussian_program();
Program guided_program();
Program nfor_program();
Program nlm_program();
Program rhf_program();
Program rdfc_program();
Program sbf_program();
Program rpf_program();
Program statmc_program();
Program sure_atrous_program();
Program fdf_program();
Program svgf_program();

// Precondition: the filter has passes.
const Program& program_of(std::string_view filter);

}  // namespace tessera
