// SPDX-License-Identifier: Apache-2.0
#include "core/quality/luv.h"

#include <cassert>

#include "core/quality/color_space.h"

namespace tessera {
namespace {

constexpr Matrix3 kXyz = xyz_of_rgb();

Triple pixel(const Image& image, std::size_t i) {
  return {image.plane(0)[i], image.plane(1)[i], image.plane(2)[i]};
}

// Sum of the squared differences of the first `terms` of L*, u*, v*.
ErrorMap distances(const Image& x, const Image& r, int terms) {
  assert(x.region() == r.region() && x.planes() >= 3 && r.planes() >= 3);
  ErrorMap map{x.region(), std::vector<double>(x.plane(0).size())};
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const Triple a = luv(kXyz * pixel(x, i)), b = luv(kXyz * pixel(r, i));
    for (int k = 0; k < terms; ++k) map.values[i] += (double{a[k]} - b[k]) * (double{a[k]} - b[k]);
  }
  return map;
}

}  // namespace

ErrorMap luv_error_map(const Image& x, const Image& r) { return distances(x, r, 3); }
ErrorMap lightness_error_map(const Image& x, const Image& r) { return distances(x, r, 1); }

}  // namespace tessera
