// SPDX-License-Identifier: Apache-2.0
// Error metrics of images against a reference. RGB planes 0..2, linear radiance, over equal regions that are
// not empty. Sums are in double. Nothing is skipped: a value that is not finite makes the means not finite.
#pragma once

#include <vector>

#include "core/image.h"

namespace tessera {

inline constexpr double kRelMseEpsilon = 0.01;  // for images exposed to a median of about 1

// Mean over pixels and channels of (x - r)^2 / (r^2 + 0.01); Rousselle et al. 2011. Companion: without the
// worst 0.1 % of the pixels (rounded down), but NaN if any pixel is not finite.
double rel_mse(const Image& x, const Image& r);
double rel_mse_trimmed(const Image& x, const Image& r);
double mse(const Image& x, const Image& r);   // mean over pixels and channels
double rmse(const Image& x, const Image& r);  // sqrt(mse)

// Planes 0..2 as clamp(c 2^ev, 0, 1) through the sRGB curve (IEC 61966-2-1). NaN stays NaN.
Image displayed(const Image& linear, float exposure = 0.0f);

// Wang et al. 2004 on the display image, per channel and averaged; Gaussian 11x11, sigma 1.5, K1 0.01, K2
// 0.03, L 1, over the pixels whose window lies inside: NaN if none does (an edge below 11 pixels).
double ssim(const Image& x, const Image& r, float exposure = 0.0f);

// Jumps of the error across tile borders against those across the lines half a tile away: 1 = no seam,
// whatever the picture. Each direction that has borders counts alike. NaN if there is no border in the image,
// or no line between the borders; infinite if the only jumps are at the borders.
double seam(const Image& x, const Image& r, Size tile);

// Per pixel mean over the channels of (x - r)^2 / (r^2 + 0.01).
Image rel_mse_map(const Image& x, const Image& r);

}  // namespace tessera
