// SPDX-License-Identifier: Apache-2.0
// Planes of floats over a region: one contiguous row-major plane per channel (SoA), from film to kernel to
// file.
#pragma once

#include <span>

#include "core/floats.h"
#include "core/region.h"

namespace tessera {

class Image {
 public:
  Image() = default;
  Image(const Region& region, int planes, float value = 0.0f)
      : region_(region), planes_(planes), data_(static_cast<std::size_t>(region.area()) * planes, value) {}
  // Takes `data` of exactly planes * area floats, plane after plane.
  Image(const Region& region, int planes, Floats data);
  // Its pixels are anything: for who writes all of them.
  static Image unset(const Region& region, int planes);

  const Region& region() const { return region_; }
  int planes() const { return planes_; }
  // The same memory, or more if it has to be, for another region. What the planes hold is anything.
  void reshape(const Region& region, int planes);
  bool empty() const { return data_.empty(); }

  std::span<float> plane(int p) { return {data_.data() + offset(p), plane_size()}; }
  std::span<const float> plane(int p) const { return {data_.data() + offset(p), plane_size()}; }
  // Pixel (x, y) in global coordinates; must lie in region().
  float& at(int p, int x, int y) { return data_[offset(p) + index(x, y)]; }
  float at(int p, int x, int y) const { return data_[offset(p) + index(x, y)]; }
  std::span<float> row(int p, int y) { return plane(p).subspan(index(region_.x0, y), region_.width()); }
  std::span<const float> row(int p, int y) const {
    return plane(p).subspan(index(region_.x0, y), region_.width());
  }

  std::span<float> data() { return data_; }
  std::span<const float> data() const { return data_; }
  Floats release() && { return std::move(data_); }

  bool operator==(const Image&) const = default;  // by value: -0 equals 0, NaN differs; tests compare bits

 private:
  std::size_t plane_size() const { return static_cast<std::size_t>(region_.area()); }
  std::size_t offset(int p) const { return plane_size() * p; }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region_.y0) * region_.width() + (x - region_.x0);
  }

  Region region_;
  int planes_ = 0;
  Floats data_;
};

// The part of `image` in `region`, which must lie inside it.
Image cropped(const Image& image, const Region& region);

// Copies the pixels that both images cover from `source` into `target` (same number of planes).
void paste(Image& target, const Image& source);

// Planes [first, first + count) of an image. Precondition: it has them.
Image planes_of(const Image& image, int first, int count);

// True if region, planes and every bit of every float agree.
bool same_bits(const Image& a, const Image& b);

}  // namespace tessera
