// SPDX-License-Identifier: Apache-2.0
// A test for many seeds, in parts that ctest runs apart. TESSERA_STORM_SEEDS says how many there are in each
// part; a failure prints the seed that makes it again.
#pragma once

#include <gtest/gtest.h>

#include <cstdlib>
#include <string>

namespace tessera::sim {

inline constexpr int kParts = 8;

class Seeds : public testing::TestWithParam<int> {
 protected:
  template <class Body>
  void for_each_seed(int usually, Body body) {
    const char* wanted = std::getenv("TESSERA_STORM_SEEDS");
    const int count = wanted ? std::atoi(wanted) : usually;
    for (int i = 0; i < count; ++i) {
      const std::uint64_t seed = static_cast<std::uint64_t>(GetParam()) * count + i;
      SCOPED_TRACE("seed " + std::to_string(seed));
      body(seed);
      if (HasFailure()) return;
    }
  }
};

}  // namespace tessera::sim
