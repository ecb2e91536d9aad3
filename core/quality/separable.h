// SPDX-License-Identifier: Apache-2.0
// Small convolutions of planes, one direction at a time, and the Gaussians they are made with. For metrics;
// the kernels that denoise are elsewhere.
#pragma once

#include <span>
#include <vector>

#include "core/region.h"

namespace tessera {

// exp(-k^2 / (2 sigma^2)) for k from -radius to radius; gaussian() has the sum 1.
std::vector<double> bell(double sigma, int radius);
std::vector<double> gaussian(double sigma, int radius);

// out(x) = sum_k kernel[k] in(x + k), with the kernel centred; outside, the pixels of the edge go on.
template <typename T>
std::vector<T> along_rows(std::span<const T> plane, Size, std::span<const double> kernel);
template <typename T>
std::vector<T> along_columns(std::span<const T> plane, Size, std::span<const double> kernel);

}  // namespace tessera
