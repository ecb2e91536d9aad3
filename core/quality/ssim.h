// SPDX-License-Identifier: Apache-2.0
// Structural similarity (Wang, Bovik, Sheikh, Simoncelli 2004), on values as displayed.
#pragma once

#include "core/quality/error_map.h"

namespace tessera {

inline constexpr int kSsimRadius = 5;

// Per pixel 1 - SSIM, the mean over the channels: Gaussian 11 x 11, sigma 1.5, K1 0.01, K2 0.03, L 1, at the
// pixels whose window lies inside. Empty if none does (an edge below 11 pixels).
ErrorMap dissimilarity_map(const Image& x, const Image& r);

double ssim(const Image& x, const Image& r);  // mean; NaN without pixels

}  // namespace tessera
