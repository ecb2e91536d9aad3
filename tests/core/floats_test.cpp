// SPDX-License-Identifier: Apache-2.0
#include "core/floats.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>

namespace tessera {
namespace {

constexpr std::size_t kSmall = 1000, kLarge = 9 << 18;  // 9 MiB

TEST(Floats, OfEverySizeAreWhatTheyAreSetTo) {
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, kSmall, kLarge}) {
    Floats floats(n, 1.0f);
    floats.resize(2 * n, 2.0f);
    EXPECT_EQ(std::ranges::count(floats, 1.0f), static_cast<std::ptrdiff_t>(n));
    EXPECT_EQ(std::ranges::count(floats, 2.0f), static_cast<std::ptrdiff_t>(n));
  }
}

TEST(Floats, OfSomeMegabytesAreAlignedToLargePages) {
  const Floats floats(kLarge);
  EXPECT_EQ(reinterpret_cast<std::uintptr_t>(floats.data()) % (2 << 20), 0u);
}

TEST(Floats, KeepTheirMemoryWhenTheyAreMoved) {
  for (const std::size_t n : {kSmall, kLarge}) {
    Floats from(n, 1.0f);
    const float* memory = from.data();
    const Floats to = std::move(from);
    EXPECT_EQ(to.data(), memory);
  }
}

}  // namespace
}  // namespace tessera
