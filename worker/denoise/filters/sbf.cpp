// SPDX-License-Identifier: Apache-2.0
// SBF (Li, Wu and Chuang 2012): a bank of cross-bilateral filters with their errors, then the best of each
// pixel.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr double kLeastVariance = 1e-2;  // of features
constexpr int kSpatialWeights = 17 * 17;

double binary_exponent(double sigma) { return std::numbers::log2e / (2 * sigma * sigma); }

// What a feature is stored times, so that the square of a difference is its exponent to base 2. Whatever the
// diameter, what is no sky stays finite.
float scale(double sigma, double unit = 1) {
  return static_cast<float>(std::min(1e7, std::sqrt(binary_exponent(sigma) / kLeastVariance) / unit));
}

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const int filters = static_cast<int>(plan["filters"]);
  const double diameter = plan["diameter"] > 0 ? plan["diameter"] : 1;
  const Planes guides = s.planes(10, std::numeric_limits<float>::infinity());
  const Planes signal = s.planes(6), results = s.planes(4 * filters);
  const Planes spatial = s.scratch(static_cast<std::size_t>(filters + 1) * kSpatialWeights);
  s.run("sbf_spatial", {0, 0, 1, filters + 1}, 1, static_cast<float>(binary_exponent(1)),
        static_cast<float>(binary_exponent(plan["smoothing"])), spatial);
  const float least = static_cast<float>(1 / kLeastVariance);
  const cl_float4 scales{
      {scale(plan["sigma_d"], diameter), scale(plan["sigma_n"]), scale(plan["sigma_a"]), 0}};
  const cl_float4 units{{static_cast<float>(std::min(1e7, least / (diameter * diameter))), least, least, 0}};
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), s.outer().height(), guides, signal, s.layout(),
        scales, units);
  s.run("sbf_bank", s.region(0), 1, guides, signal, spatial, results, s.layout(), s.region(0));
  s.run("sbf_select", s.region(1), 1, guides, signal, spatial, results, s.layout(), s.region(1));
  s.run("finish", s.inner(), 1, s.input(), s.outer().width(), s.outer().height(), guides, signal, s.layout(),
        Exactly{s.inner()}, s.output());
}

std::string options(const FilterPlan& plan) {
  return fmt::format("-DBANK={} -DNOISY={} -DSMOOTHING={}", plan["filters"], plan["unfiltered"],
                     std::ceil(2 * plan["smoothing"]));
}

}  // namespace

Program sbf_program() { return {"sbf", {kernels::sbf_cl}, options, run}; }

}  // namespace tessera
