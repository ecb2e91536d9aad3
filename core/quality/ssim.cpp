// SPDX-License-Identifier: Apache-2.0
#include "core/quality/ssim.h"

#include <cassert>

#include "core/quality/separable.h"

namespace tessera {
namespace {

constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;

std::vector<double> product(std::span<const float> a, std::span<const float> b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = double{a[i]} * b[i];
  return out;
}

// The mean under the window around each pixel; of use only where the window lies inside.
std::vector<double> windowed(const std::vector<double>& plane, Size size) {
  static const std::vector<double> kWindow = gaussian(1.5, kSsimRadius);
  return along_columns<double>(along_rows<double>(plane, size, kWindow), size, kWindow);
}

void add_dissimilarity(std::span<const float> x, std::span<const float> r, const Region& frame,
                       ErrorMap& to) {
  const Size size{frame.width(), frame.height()};
  const auto mx = windowed({x.begin(), x.end()}, size), mr = windowed({r.begin(), r.end()}, size);
  const auto xx = windowed(product(x, x), size), rr = windowed(product(r, r), size);
  const auto xr = windowed(product(x, r), size);
  std::size_t at = 0;
  for (int y = kSsimRadius; y < size.height - kSsimRadius; ++y)
    for (int c = kSsimRadius; c < size.width - kSsimRadius; ++c, ++at) {
      const std::size_t i = static_cast<std::size_t>(y) * size.width + c;
      const double sx = xx[i] - mx[i] * mx[i], sr = rr[i] - mr[i] * mr[i], sxr = xr[i] - mx[i] * mr[i];
      const double ssim = (2 * mx[i] * mr[i] + kC1) * (2 * sxr + kC2) /
                          ((mx[i] * mx[i] + mr[i] * mr[i] + kC1) * (sx + sr + kC2));
      to.values[at] += (1 - ssim) / 3;
    }
}

}  // namespace

ErrorMap dissimilarity_map(const Image& x, const Image& r) {
  assert(x.region() == r.region() && x.planes() >= 3 && r.planes() >= 3);
  const Region inside = grown(x.region(), -kSsimRadius);
  if (inside.empty()) return {};
  ErrorMap map{inside, std::vector<double>(static_cast<std::size_t>(inside.area()))};
  for (int c = 0; c < 3; ++c) add_dissimilarity(x.plane(c), r.plane(c), x.region(), map);
  return map;
}

double ssim(const Image& x, const Image& r) { return 1 - mean(dissimilarity_map(x, r)); }

}  // namespace tessera
