// SPDX-License-Identifier: Apache-2.0
// Random Parameter Filtering (Sen and Darabi 2012): samples as lines, four iterations, their means.
#include "core/filter/rpf.h"

#include <cmath>
#include <numbers>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr int kOffsets = 4096;       // equally likely ones of an iteration
constexpr int kMostSamples = 16384;  // of a neighbourhood; both as in the kernels
constexpr double kUnits = 16384;     // of n log2 n

double normal_distribution(double x) { return std::erfc(-x / std::numbers::sqrt2) / 2; }

// Inverse of the distribution of a coordinate in the box: four bytes an int, least significant first.
std::vector<cl_int> offset_table(const FilterPlan& plan) {
  std::vector<cl_int> table;
  for (int t = 0; t < kRpfIterations; ++t) {
    const RpfIteration i = rpf_iteration(plan.parameters, t);
    const auto below = [&](int offset) { return normal_distribution((offset - 0.5) / i.deviation); };
    const double first = below(-i.radius), all = below(i.radius + 1) - first;
    int offset = -i.radius;
    for (int k = 0; k < kOffsets; ++k) {
      while (offset < i.radius && (below(offset + 1) - first) / all * kOffsets <= k + 0.5) ++offset;
      if (k % 4 == 0) table.push_back(0);
      table.back() |= (offset + i.radius) << 8 * (k % 4);
    }
  }
  return table;
}

std::vector<cl_int> entropy_table() {
  std::vector<cl_int> table{0};
  for (int n = 1; n < kMostSamples; ++n)
    table.push_back(static_cast<cl_int>(static_cast<cl_uint>(std::llround(kUnits * n * std::log2(n)))));
  return table;
}

cl_float4 floats(double a, double b, double c, double d) {
  return {{static_cast<float>(a), static_cast<float>(b), static_cast<float>(c), static_cast<float>(d)}};
}

void run(Stage& s) {
  const RpfConstants c = rpf_constants(s.plan().parameters);
  const int w = s.outer().width(), h = s.outer().height();
  const auto area = static_cast<std::size_t>(s.outer().area());
  const Planes samples = s.scratch(8 * 32 * area), to = s.scratch(24 * area), counts = s.scratch(area);
  const cl::Buffer offsets = s.table(offset_table(s.plan())), entropies = s.table(entropy_table());
  s.run("rpf_prepare", s.outer(), 1, s.input(), w, h, static_cast<float>(c.brightest),
        cl_int{s.plan().is("second_hit", "flagged")}, samples, counts);
  for (int t = 0; t < kRpfIterations; ++t) {
    const RpfIteration i = rpf_iteration(s.plan().parameters, t);
    const Exactly over{s.region(static_cast<std::size_t>(t))};
    s.run("rpf_filter", over.region, 1, samples, counts, to, over,
          cl_int4{{w, h, s.outer().x0, s.outer().y0}}, cl_int{t}, cl_int{i.radius},
          static_cast<float>(i.draws), static_cast<cl_uint>(s.plan()["seed"]),
          floats(c.feature, c.position, c.guard, c.position_guard), cl_int{c.buckets},
          floats(i.dependence, c.color_factor, c.texture_factor, c.normal_factor),
          static_cast<float>(c.variance), cl_int{c.spikes}, offsets, entropies);
    s.run("rpf_commit", over.region, 1, samples, counts, to, w, over);
  }
  s.run("rpf_finish", s.inner(), 1, s.input(), w, h, samples, counts, Exactly{s.inner()}, s.output());
}

}  // namespace

Program rpf_program() {
  return {"rpf",
          {kernels::rpf_neighbours_cl, kernels::rpf_information_cl, kernels::rpf_cl},
          [](const FilterPlan&) { return std::string(); },
          run};
}

}  // namespace tessera
