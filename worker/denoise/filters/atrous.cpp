// SPDX-License-Identifier: Apache-2.0
// EAW (Dammertz et al. 2010): demodulate, accumulate over frames, five levels, modulate.
#include <limits>
#include <utility>

#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/taa.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

// The colour's sigma halves with every level, the others double: Dammertz et al. 2010, section 3.
cl_float4 scalars(const FilterPlan& plan, const Pass& pass) {
  return {{exponent_over_square(plan["sigma_c"] / pass.step),
           exponent_over_square(plan["sigma_n"] * pass.step),
           exponent_over_square(plan["sigma_x"] * pass.step), 0}};
}

void run(Stage& s) {
  const Planes guides = s.planes(6, std::numeric_limits<float>::infinity());
  Planes from = s.planes(3), to = s.planes(3);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, from, s.layout());
  for (std::size_t i = 0; i < s.passes().size(); ++i) {
    const Pass& pass = s.passes()[i];
    if (pass.kernel == "atrous_accumulate") {
      s.run("atrous_accumulate", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, from,
            s.layout(), Past{}, Exactly{s.inner()}, s.output(), static_cast<float>(s.plan()["alpha"]),
            cl_int{s.plan().is("average", "plain")});
      continue;
    }
    if (pass.kernel != "atrous_level") continue;
    s.run("atrous_level", s.region(i), pass.step, guides, from, to, s.layout(), s.region(i), pass.step,
          scalars(s.plan(), pass));
    std::swap(from, to);
  }
  const Picture result = picture(s);
  s.run("finish", result.region, 1, s.input(), s.outer().width(), s.outer().height(), guides, from,
        s.layout(), Exactly{result.region}, result.buffer);
  taa(s, result);
}

}  // namespace

Program atrous_program() {
  return {"atrous",
          {kernels::geometry_cl, kernels::history_cl, kernels::taa_cl, kernels::atrous_cl,
           kernels::atrous_history_cl},
          [](const FilterPlan&) { return std::string(); },
          run};
}

}  // namespace tessera
