// SPDX-License-Identifier: Apache-2.0
#include "core/quality/metrics.h"

#include <cassert>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

double squared(double v) { return v * v; }

// Folds each channel of each pixel into its error: error = fold(error, x, r), from 0.
template <typename Fold>
ErrorMap each_channel(const Image& x, const Image& r, const Fold& fold) {
  assert(x.region() == r.region() && !x.region().empty() && x.planes() >= 3 && r.planes() >= 3);
  ErrorMap map{x.region(), std::vector<double>(x.plane(0).size())};
  for (int c = 0; c < 3; ++c) {
    const auto a = x.plane(c), b = r.plane(c);
    for (std::size_t i = 0; i < map.values.size(); ++i) map.values[i] = fold(map.values[i], a[i], b[i]);
  }
  return map;
}

}  // namespace

ErrorMap rel_mse_map(const Image& x, const Image& r) {
  return each_channel(x, r, [](double sum, double a, double b) {
    return sum + squared(a - b) / (squared(b) + kRelMseEpsilon) / 3.0;
  });
}
double rel_mse(const Image& x, const Image& r) { return mean(rel_mse_map(x, r)); }
double rel_mse_trimmed(const Image& x, const Image& r) { return trimmed_mean(rel_mse_map(x, r)); }

ErrorMap square_error_map(const Image& x, const Image& r) {
  return each_channel(x, r, [](double sum, double a, double b) { return sum + squared(a - b); });
}
double mse(const Image& x, const Image& r) { return mean(square_error_map(x, r)) / 3.0; }
double rmse(const Image& x, const Image& r) { return std::sqrt(mse(x, r)); }
double psnr(const Image& x, const Image& r) { return -10.0 * std::log10(mse(x, r)); }

ErrorMap smape_map(const Image& x, const Image& r) {
  return each_channel(x, r, [](double sum, double a, double b) {
    return sum + std::abs(a - b) / (std::abs(a) + std::abs(b) + 0.01) / 3.0;
  });
}

ErrorMap difference_map(const Image& x, const Image& r) {
  return each_channel(x, r, [](double most, double a, double b) {
    const double d = std::abs(a - b);
    return d <= most || std::isnan(most) ? most : d;
  });
}

}  // namespace tessera
