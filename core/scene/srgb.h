// SPDX-License-Identifier: Apache-2.0
// Colours as programs show them, to linear ones.
#pragma once

#include <cmath>

namespace tessera {

// IEC 61966-2-1:1999, section 5.2: the inverse of the sRGB transfer function.
inline float from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

}  // namespace tessera
