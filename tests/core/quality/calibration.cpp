// SPDX-License-Identifier: Apache-2.0
// Prints the tables of docs/METRICS.md: how well the error estimate is calibrated, and what the stop rule
// accepts and costs.   calibration [worlds]
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "tests/core/quality/simulation.h"

namespace tessera::simulation {
namespace {

constexpr Size kSize{192, 192};

// The mean of Y over (2 radius + 1)^2 pixels as the r of 1 / (r^2 + epsilon); radius -1: the truth.
Image weight_by(const Image& r, int radius) {
  Image out(r.region(), 3);
  for (int c = 0; c < 3; ++c)
    for (int y = r.region().y0; y < r.region().y1; ++y)
      for (int x = r.region().x0; x < r.region().x1; ++x) {
        const Region window = intersect({x - radius, y - radius, x + radius + 1, y + radius + 1}, r.region());
        double sum = 0;
        for (int v = window.y0; v < window.y1; ++v)
          for (int u = window.x0; u < window.x1; ++u) sum += r.at(c, u, v);
        const double mean = sum / static_cast<double>(window.area());
        out.at(c, x, y) = static_cast<float>(1 / (mean * mean + kRelMseEpsilon));
      }
  return out;
}

void print_weights(Denoiser denoiser, int samples, const Fireflies& fireflies, int worlds) {
  constexpr int kRadii[] = {-1, 0, 1, 2, 4, 8};
  double truth = 0, sums[6] = {}, covered[6] = {}, cells = 0;
  for (int seed = 0; seed < worlds; ++seed) {
    Renderer renderer(make_world(kSize, seed, fireflies), 1000 + seed);
    renderer.render(renderer.sums().region(), samples);
    const Look look(renderer, denoiser);
    for (int k = 0; k < 6; ++k) {
      const Image weight =
          kRadii[k] < 0 ? weight_by(renderer.world().expected, 0) : weight_by(look.y, kRadii[k]);
      for (const Region& cell : grid_cells(renderer.sums().region(), {kCellEdge, kCellEdge})) {
        const ErrorEstimate e = estimate_from_halves(look.halves(), weight, cell);
        const double error = true_error(look.y, renderer.world().expected, cell);
        sums[k] += e.mean;
        covered[k] += error <= e.upper(1.645);
        if (k == 0) truth += error, cells += 1;
      }
    }
  }
  fmt::print("{} {:4} spp, fireflies {:g} x {:g}: true {:.5f}\n",
             denoiser == Denoiser::atrous ? "atrous   " : "bilateral", samples, fireflies.rate,
             fireflies.value, truth / cells);
  fmt::print("   r =          truth   Y       3x3     5x5     9x9     17x17\n   mean ratio ");
  for (double s : sums) fmt::print("  {:.3f} ", s / truth);
  fmt::print("\n   coverage   ");
  for (double c : covered) fmt::print("  {:.3f} ", c / cells);
  fmt::print("\n");
}

void print_rule(Denoiser denoiser, double target, const Fireflies& fireflies, int worlds) {
  for (const RuleVariant variant : {RuleVariant::naive, RuleVariant::no_guards, RuleVariant::full}) {
    Outcome sum;
    for (int seed = 0; seed < worlds; ++seed)
      sum += run_rule(kSize, seed, denoiser, target, fireflies, variant);
    fmt::print(
        "{} target {:<6} fireflies {:g} x {:g} {:<10} cells {:3.0f} accepted {:5.1f} % above target {:4.1f} "
        "% (Y {:4.1f} %) "
        "error/target {:.2f} samples/oracle {:.2f} (alone {:.2f})\n",
        denoiser == Denoiser::atrous ? "atrous   " : "bilateral", target, fireflies.rate, fireflies.value,
        variant == RuleVariant::naive       ? "naive"
        : variant == RuleVariant::no_guards ? "no guards"
                                            : "full",
        sum.cells, 100 * sum.accepted / sum.cells, 100 * sum.violations / std::max(1.0, sum.accepted),
        100 * sum.violations_of_y / std::max(1.0, sum.accepted),
        sum.error / std::max(1.0, sum.accepted) / target, sum.samples / sum.oracle_samples,
        sum.samples_alone / sum.oracle_samples);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace tessera::simulation

int main(int argc, char** argv) {
  using namespace tessera::simulation;
  const int worlds = argc > 1 ? std::atoi(argv[1]) : 24;
  for (const Fireflies& fireflies : {Fireflies{}, Fireflies{1e-5, 300}})
    for (const Denoiser denoiser : {Denoiser::bilateral, Denoiser::atrous}) {
      for (const int samples : {16, 64, 256, 1024}) print_weights(denoiser, samples, fireflies, worlds);
      for (const double target : {0.01, 0.005}) print_rule(denoiser, target, fireflies, worlds);
    }
}
