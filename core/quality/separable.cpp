// SPDX-License-Identifier: Apache-2.0
#include "core/quality/separable.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numeric>

namespace tessera {

std::vector<double> bell(double sigma, int radius) {
  std::vector<double> values;
  for (int k = -radius; k <= radius; ++k) values.push_back(std::exp(-0.5 * (k / sigma) * (k / sigma)));
  return values;
}

std::vector<double> gaussian(double sigma, int radius) {
  std::vector<double> values = bell(sigma, radius);
  const double sum = std::accumulate(values.begin(), values.end(), 0.0);
  for (double& v : values) v /= sum;
  return values;
}

template <typename T>
std::vector<T> along_rows(std::span<const T> plane, Size size, std::span<const double> kernel) {
  assert(kernel.size() % 2 == 1 && size.width > 0);
  const std::size_t width = static_cast<std::size_t>(size.width), radius = kernel.size() / 2;
  std::vector<T> out(plane.size()), padded(width + 2 * radius);
  for (std::size_t start = 0; start < plane.size(); start += width) {
    const auto row = plane.subspan(start, width);
    std::fill_n(padded.begin(), radius, row.front());
    std::ranges::copy(row, padded.begin() + static_cast<std::ptrdiff_t>(radius));
    std::fill_n(padded.end() - static_cast<std::ptrdiff_t>(radius), radius, row.back());
    T* const to = out.data() + start;
    for (std::size_t k = 0; k < kernel.size(); ++k) {
      const T weight = static_cast<T>(kernel[k]);
      const T* const from = padded.data() + k;
      for (std::size_t x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
  return out;
}

template <typename T>
std::vector<T> along_columns(std::span<const T> plane, Size size, std::span<const double> kernel) {
  assert(kernel.size() % 2 == 1 && size.height > 0);
  const std::size_t width = static_cast<std::size_t>(size.width);
  const int radius = static_cast<int>(kernel.size() / 2);
  std::vector<T> out(plane.size());
  for (int y = 0; y < size.height; ++y) {
    T* const to = out.data() + static_cast<std::size_t>(y) * width;
    for (int k = -radius; k <= radius; ++k) {
      const T weight = static_cast<T>(kernel[static_cast<std::size_t>(k + radius)]);
      const T* const from =
          plane.data() + static_cast<std::size_t>(std::clamp(y + k, 0, size.height - 1)) * width;
      for (std::size_t x = 0; x < width; ++x) to[x] += weight * from[x];
    }
  }
  return out;
}

template std::vector<float> along_rows(std::span<const float>, Size, std::span<const double>);
template std::vector<float> along_columns(std::span<const float>, Size, std::span<const double>);
template std::vector<double> along_rows(std::span<const double>, Size, std::span<const double>);
template std::vector<double> along_columns(std::span<const double>, Size, std::span<const double>);

}  // namespace tessera
