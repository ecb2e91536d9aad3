// SPDX-License-Identifier: Apache-2.0
// Pictures for the tests of metrics.
#pragma once

#include <random>

#include "core/image.h"

namespace tessera {

inline Image noise(const Region& region, unsigned seed, float low = 0.0f, float high = 1.0f) {
  Image image(region, 3);
  std::mt19937 random(seed);
  std::uniform_real_distribution<float> value(low, high);
  for (float& v : image.data()) v = value(random);
  return image;
}

inline Image constant(const Region& region, float r, float g, float b) {
  Image image(region, 3);
  std::ranges::fill(image.plane(0), r);
  std::ranges::fill(image.plane(1), g);
  std::ranges::fill(image.plane(2), b);
  return image;
}

}  // namespace tessera
