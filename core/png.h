// SPDX-License-Identifier: Apache-2.0
// Pictures for people: 8-bit PNG of linear images.
#pragma once

#include <filesystem>
#include <vector>

#include "core/image.h"

namespace tessera {

// Planes 0..2 as RGB, times 2^exposure, clipped, sRGB; NaN is black. A plane 3 is the alpha by which the
// colours are multiplied. Written beside and renamed. Throws InputError for a place that cannot be written.
void write_png(const std::filesystem::path& file, const Image&, float exposure = 0.0f);

// Plane 0 through a perceptually even colour map (black-purple-orange-yellow), `low` to `high`, as linear
// RGB; beyond, the end colours. NaN is cyan, which the map does not hold.
Image heat_map(const Image& values, float low, float high);

// Images of equal height beside each other, with `gap` white pixels between them. Planes 0..2; the result
// starts at (0, 0).
Image side_by_side(const std::vector<Image>& images, int gap = 4);

}  // namespace tessera
