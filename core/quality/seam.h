// SPDX-License-Identifier: Apache-2.0
// Whether tiles show. For the exact question, whether an image of tiles is the whole image, see
// difference_map.
#pragma once

#include "core/image.h"

namespace tessera {

// Jumps of the error across tile borders against those across the lines half a tile away: 1 = no seam,
// whatever the picture. Each direction that has borders counts alike. NaN if there is no border in the image,
// or no line between the borders; infinite if the only jumps are at the borders.
double seam(const Image& x, const Image& r, Size tile);

}  // namespace tessera
