// SPDX-License-Identifier: Apache-2.0
// What a screen shows of linear radiance: the display transform of every metric that judges pictures as seen.
// No tone mapping; that of HDR-FLIP is in hdr_flip.
#pragma once

#include <string>

#include "core/image.h"

namespace tessera {

// From linear 0..1 to the values of a picture: the sRGB curve (IEC 61966-2-1), or v^(1/2.2) as many papers
// have it. Figures of one are never comparable with those of the other.
enum class Curve : unsigned char { srgb, gamma };

struct Display {
  Curve curve = Curve::srgb;
  float exposure = 0;  // in stops
  bool operator==(const Display&) const = default;
};

std::string to_string(Curve);  // "sRGB", "gamma 2.2"

// Planes 0..2 as curve(clamp(c 2^exposure, 0, 1)). NaN stays NaN.
Image displayed(const Image& linear, const Display& = {});

// The light, 0..1, that an sRGB screen makes of `displayed`: what a metric of perception gets.
Image screen_light(const Image& linear, const Display& = {});

}  // namespace tessera
