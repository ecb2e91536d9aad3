// SPDX-License-Identifier: Apache-2.0
#include "core/image.h"

#include <algorithm>
#include <cassert>
#include <cstring>

namespace tessera {

Image::Image(const Region& region, int planes, Floats data)
    : region_(region), planes_(planes), data_(std::move(data)) {
  assert(data_.size() == static_cast<std::size_t>(region.area()) * planes);
}

Image Image::unset(const Region& region, int planes) {
  Image image;
  image.reshape(region, planes);
  return image;
}

void Image::reshape(const Region& region, int planes) {
  region_ = region;
  planes_ = planes;
  data_.resize(static_cast<std::size_t>(region.area()) * planes);
}

void paste(Image& target, const Image& source) {
  assert(target.planes() == source.planes());
  const Region both = intersect(target.region(), source.region());
  if (both.empty()) return;
  for (int p = 0; p < source.planes(); ++p)
    for (int y = both.y0; y < both.y1; ++y) {
      const auto from = source.row(p, y).subspan(both.x0 - source.region().x0, both.width());
      std::copy(from.begin(), from.end(), target.row(p, y).begin() + (both.x0 - target.region().x0));
    }
}

Image cropped(const Image& image, const Region& region) {
  assert(image.region().contains(region));
  Image part = Image::unset(region, image.planes());
  paste(part, image);
  return part;
}

Image planes_of(const Image& image, int first, int count) {
  assert(first >= 0 && count >= 0 && first + count <= image.planes());
  Image part = Image::unset(image.region(), count);
  const auto from = image.data().subspan(static_cast<std::size_t>(image.region().area()) * first);
  std::copy_n(from.begin(), part.data().size(), part.data().begin());
  return part;
}

bool same_bits(const Image& a, const Image& b) {
  return a.region() == b.region() && a.planes() == b.planes() &&
         (a.empty() || std::memcmp(a.data().data(), b.data().data(), a.data().size_bytes()) == 0);
}

}  // namespace tessera
