// SPDX-License-Identifier: Apache-2.0
// SVGF (Schied et al. 2017): demodulate, accumulate over frames, find the variance, five levels, modulate.
#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <numbers>
#include <utility>

#include "core/filter/descriptions.h"
#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/taa.h"

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

bool has_history(const FilterPlan& plan) { return with_history(plan.parameters); }

// After how many levels light is kept for the next frame.
int fed_back(const FilterPlan& plan) { return static_cast<int>(std::min(plan["feedback"], plan["levels"])); }

void accumulate(Stage& s, const Planes& guides, const Planes& signal, const Planes& raw) {
  const cl_float2 alpha{
      {static_cast<float>(s.plan()["alpha"]), static_cast<float>(s.plan()["alpha_moments"])}};
  s.run("svgf_accumulate", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, signal,
        raw, s.layout(), Past{}, cl_int{fed_back(s.plan()) == 0}, Exactly{s.inner()}, s.output(), alpha,
        cl_int{s.plan().is("average", "plain")});
}

void run(Stage& s) {
  const bool history = has_history(s.plan());
  const Planes guides = s.planes(history ? 5 : 4, std::numeric_limits<float>::infinity());
  Planes from = s.planes(8), to = s.planes(8);
  // The variances of single pixels wait in `to` until they are found over the pixels around.
  if (history)
    accumulate(s, guides, from, to);
  else
    s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, from, to,
          s.layout());
  std::size_t i = history ? 1 : 0;
  const auto pass_over = [&](const auto& source, const auto& target, const auto&... more) {
    const Pass& pass = s.passes()[i];
    s.run(std::string(pass.kernel).c_str(), s.region(i), pass.step, guides, source, target, s.layout(),
          s.region(i), pass.step, scalars(s.plan(), pass), more...);
    ++i;
  };
  pass_over(to, from);
  const Picture result = picture(s);
  for (int level = 1; level <= s.plan()["levels"]; ++level, std::swap(from, to)) {
    const cl_int kept = history && level == fed_back(s.plan());
    const Exactly inner{s.inner()};
    if (level < s.plan()["levels"])
      pass_over(from, to, kept, inner, s.output());
    else
      pass_over(from, result.buffer, kept, inner, s.output(), s.input(), s.outer().width(),
                s.outer().height(), Exactly{result.region});
  }
  taa(s, result);
}

// The parameter's choices are the powers of two in order.
std::string options(const FilterPlan& plan) {
  return fmt::format("-DSQUARINGS={}{}", plan["sigma_n"], plan.is("variance", "spatial") ? " -DMOMENTS" : "");
}

}  // namespace

Program svgf_program() {
  return {"svgf",
          {kernels::geometry_cl, kernels::history_cl, kernels::taa_cl, kernels::svgf_pixels_cl,
           kernels::svgf_cl, kernels::svgf_history_cl},
          options,
          run};
}

}  // namespace tessera
