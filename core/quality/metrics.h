// SPDX-License-Identifier: Apache-2.0
// Error metrics of images against a reference that look at each pixel alone. RGB planes 0..2 over equal
// regions that are not empty, linear or as displayed: the caller's choice, which belongs beside every figure.
// Sums are in double. Nothing is skipped: a value that is not finite makes the means not finite.
#pragma once

#include "core/image.h"
#include "core/quality/error_map.h"

namespace tessera {

inline constexpr double kRelMseEpsilon = 0.01;  // for images exposed to a median of about 1

// Per pixel the mean over the channels of (x - r)^2 / (r^2 + 0.01); Rousselle et al. 2011.
ErrorMap rel_mse_map(const Image& x, const Image& r);
double rel_mse(const Image& x, const Image& r);
double rel_mse_trimmed(const Image& x, const Image& r);  // see trimmed_mean

// Per pixel the sum over the channels of (x - r)^2. Its mean is MSE0, three times the usual MSE.
ErrorMap square_error_map(const Image& x, const Image& r);
double mse(const Image& x, const Image& r);   // mean over pixels and channels
double rmse(const Image& x, const Image& r);  // sqrt(mse)

// Of values as displayed, whose largest is 1: -10 log10(mse). Infinite for equal images.
double psnr(const Image& x, const Image& r);

// Per pixel the mean over the channels of |x - r| / (|x| + |r| + 0.01), below 1 each.
ErrorMap smape_map(const Image& x, const Image& r);

// Per pixel the largest |x - r| of its channels; NaN if one is NaN.
ErrorMap difference_map(const Image& x, const Image& r);

}  // namespace tessera
