// SPDX-License-Identifier: Apache-2.0
// StatMC (Sakai et al. 2024): what the tests need of each pixel, then one gather over a disc.
#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

// Two pixels of n samples and equal variances have 2 n - 2 degrees of freedom in Welch's test. Quantiles of
// up to this many samples are in a table, of more come from an expansion.
constexpr int kTable = 32;

constexpr int kPlanes = 15;  // of the strips: see kernels/statmc.cl

// Of Student's t with an even number of degrees: how much lies within [-t, t] (Abramowitz and Stegun 1964,
// 26.7.4).
double within(double t, int degrees) {
  const double cosine2 = degrees / (degrees + t * t);
  double term = 1, sum = 1;
  for (int k = 1; k < degrees / 2; ++k) {
    term *= cosine2 * (2 * k - 1) / (2 * k);
    sum += term;
  }
  return std::sqrt(1 - cosine2) * sum;
}

// Where `share` returns 1 - level. `share` rises.
template <typename Share>
double two_sided(double level, Share share) {
  double low = 0, high = 1e4;
  for (int k = 0; k < 100; ++k) {
    const double middle = (low + high) / 2;
    (share(middle) < 1 - level ? low : high) = middle;
  }
  return low;
}

// Squares of the two-sided quantiles of 2 n - 2 degrees of freedom: of n = 0 to kTable as a list, 0 where
// there is none; and the coefficients of their square roots' expansion in 1 / degrees (Abramowitz and Stegun
// 1964, 26.7.5), which for more samples than kTable is within 1e-6 of the quantile at every level accepted.
std::string options(const FilterPlan& plan) {
  const double level = plan["level"];
  std::string list = "0,0";
  for (int n = 2; n <= kTable; ++n) {
    const double t = two_sided(level, [n](double v) { return within(v, 2 * n - 2); });
    list += fmt::format(",{:.9e}f", t * t);
  }
  const double z = two_sided(level, [](double v) { return std::erf(v / std::numbers::sqrt2); });
  const double z2 = z * z;
  return fmt::format(
      "{} -DTABLE={} -DT_SQUARED={} -DT0={:.9e}f -DT1={:.9e}f -DT2={:.9e}f -DT3={:.9e}f"
      " -DT4={:.9e}f",
      window_options(plan, kPlanes), kTable, list, z, z * (z2 + 1) / 4, z * ((5 * z2 + 16) * z2 + 3) / 96,
      z * (((3 * z2 + 19) * z2 + 17) * z2 - 15) / 384,
      z * ((((79 * z2 + 776) * z2 + 1482) * z2 - 1920) * z2 - 945) / 92160);
}

void run(Stage& s) {
  const auto of_exponent = [](double sigma) { return kOctave * std::numbers::log2e / (2 * sigma * sigma); };
  const auto scale = [&](std::string_view sigma) {
    return static_cast<float>(std::sqrt(of_exponent(s.plan()[sigma])));
  };
  const Window w = window(s, kPlanes);
  s.run("prepare", w.to_prepare, 1, s.input(), s.outer().width(), s.outer().height(), w.strips,
        Exactly{s.inner()}, scale("sigma_a"), scale("sigma_n"));
  s.run("statmc_gather", w.to_filter, 1, s.input(), s.outer().width(), s.outer().height(), w.strips,
        Exactly{s.inner()}, static_cast<float>(of_exponent(s.plan()["sigma_s"])), s.output());
}

}  // namespace

Program statmc_program() { return {"statmc", {kernels::window_cl, kernels::statmc_cl}, options, run}; }

}  // namespace tessera
