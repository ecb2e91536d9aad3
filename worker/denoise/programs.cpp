// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/programs.h"

#include <cassert>

namespace tessera {

const Program& program_of(std::string_view filter) {
  static const Program all[]{
      atrous_program(),
      bilateral_program(),
      bmfr_program(),
      box_program(),
      cross_bilateral_program(),
      fdf_program(),
      ddf_program(),
      gaussian_program(),
      guided_program(),
      nfor_program(),
      nlm_program(),
      rhf_program(),
      rpf_program(),
      rdfc_program(),
      sbf_program(),
      statmc_program(),
      sure_atrous_program(),
      svgf_program(),
  };
  for (const Program& p : all)
    if (p.name == filter) return p;
  assert(!"every filter with passes has a program");
  __builtin_unreachable();
}

}  // namespace tessera
