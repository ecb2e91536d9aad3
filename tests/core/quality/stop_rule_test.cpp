// SPDX-License-Identifier: Apache-2.0
// The stop rule as a whole, on simulated renders with a known true image.
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/quality/simulation.h"

namespace tessera::simulation {
namespace {

constexpr Size kSize{160, 128};

Outcome over_worlds(int worlds, Denoiser denoiser, double target, const Fireflies& fireflies,
                    RuleVariant variant) {
  Outcome sum;
  for (int seed = 0; seed < worlds; ++seed)
    sum += run_rule(kSize, seed, denoiser, target, fireflies, variant);
  return sum;
}

// The most violations that a rule with a rate of 5 % shows in 999 of 1000 runs.
double allowed(double accepted) { return 0.05 * accepted + 3.1 * std::sqrt(0.05 * 0.95 * accepted) + 1; }

TEST(StopRule, KeepsItsWordAtLessThanTwoAndAHalfTimesAnOraclesSamples) {
  const Outcome o = over_worlds(3, Denoiser::bilateral, 0.02, {}, RuleVariant::full);
  EXPECT_EQ(o.accepted, o.cells);
  EXPECT_LE(o.violations, allowed(o.accepted)) << "of " << o.accepted;
  EXPECT_LE(o.violations_of_y, allowed(o.accepted));
  EXPECT_LT(o.samples, 2.5 * o.oracle_samples);
  EXPECT_GT(o.samples, o.oracle_samples);
}

TEST(StopRule, KeepsItsWordWithFireflies) {
  const Outcome o = over_worlds(2, Denoiser::bilateral, 0.03, {1e-5, 300}, RuleVariant::full);
  EXPECT_GT(o.accepted, 0.9 * o.cells);
  EXPECT_LE(o.violations, allowed(o.accepted)) << "of " << o.accepted;
}

}  // namespace
}  // namespace tessera::simulation
