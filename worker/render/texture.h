// SPDX-License-Identifier: Apache-2.0
// Pictures looked up by materials.
#pragma once

#include <array>

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// Red, green, blue, alpha. Pictures of one or two channels are grey; without an alpha channel alpha is 1.
using Texel = std::array<float, 4>;

// Bilinear between pixel centres. The texture must have a picture.
Texel lookup(const Scene& scene, const Texture& texture, const Vec2& uv);

// Mean colour of a picture.
Color average(const Picture& picture);

}  // namespace tessera::tracer
