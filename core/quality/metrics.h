// SPDX-License-Identifier: Apache-2.0
// Error metrics of images against a reference. RGB planes 0..2, linear radiance, over equal regions.
#pragma once

#include <vector>

#include "core/image.h"

namespace tessera {

inline constexpr double kRelMseEpsilon = 0.01;  // for images exposed to a median of about 1

// Mean over pixels and channels of (x - r)^2 / (r^2 + 0.01); Rousselle et al. 2011. Companion: without the
// worst 0.1 % of the pixels.
double rel_mse(const Image& x, const Image& r);
double rel_mse_trimmed(const Image& x, const Image& r);
double mse(const Image& x, const Image& r);   // mean over pixels and channels
double rmse(const Image& x, const Image& r);  // sqrt(mse)

// clamp(c 2^ev, 0, 1) through the sRGB curve.
Image displayed(const Image& linear, float exposure = 0.0f);

// Wang et al. 2004 on the display image, per channel and averaged; Gaussian 11x11, sigma 1.5, K1 0.01, K2
// 0.03, over the pixels whose window lies inside. An image smaller than 11 pixels uses what there is: NaN.
double ssim(const Image& x, const Image& r, float exposure = 0.0f);

// Jumps across tile borders against jumps elsewhere, both relative to the reference: 1 = no seam. NaN if
// there is no border in the image.
double seam(const Image& x, const Image& r, Size tile);

// Per pixel mean over the channels of (x - r)^2 / (r^2 + 0.01).
Image rel_mse_map(const Image& x, const Image& r);

}  // namespace tessera
