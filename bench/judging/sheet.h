// SPDX-License-Identifier: Apache-2.0
// Pictures beside and below each other, with words above them.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "core/image.h"

namespace tessera::judging {

inline constexpr std::string_view kFont = "DejaVuSans";  // Debian: fonts-dejavu-core

// Pictures of equal size, `columns` to a row; the last row is filled up with white.
Image in_rows(const std::vector<Image>& pictures, int columns);

// The picture below a white strip with a line of text. Without the font the strip is white.
Image captioned(const Image& picture, const std::string& text);

// Each pixel as a square of `factor` x `factor`.
Image enlarged(const Image& picture, int factor);

}  // namespace tessera::judging
