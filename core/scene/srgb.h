// SPDX-License-Identifier: Apache-2.0
// Colours as programs show them, to linear ones and back.
#pragma once

#include <cmath>

namespace tessera {

// IEC 61966-2-1:1999, section 5.2: the inverse of the sRGB transfer function.
inline float from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }
inline float to_srgb(float v) {
  return v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
}

}  // namespace tessera
