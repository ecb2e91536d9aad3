// SPDX-License-Identifier: Apache-2.0
// What the scalar references share: the features of a pixel, read from a filter's input planes, in double
// precision. Written from the papers' formulas, one pixel at a time, with no thought of speed.
#pragma once

#include <array>
#include <vector>

#include "core/filter/filter.h"
#include "core/image.h"

namespace tessera::reference {

using Rgb = std::array<double, 3>;

// Planes of a filter's input by what they mean.
class Features {
 public:
  Features(const FilterPlan&, const Image& input);

  const Region& region() const { return input_.region(); }
  bool inside(int x, int y) const { return region().contains(x, y); }
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region().y0) * region().width() + (x - region().x0);
  }
  bool has(Aov a, Statistic s = Statistic::mean, Share h = Share::all) const {
    return first_plane(a, s, h) >= 0;
  }
  double at(Aov a, int channel, int x, int y, Statistic s = Statistic::mean, Share h = Share::all) const {
    return input_.at(first_plane(a, s, h) + channel, x, y);
  }
  Rgb rgb(Aov a, int x, int y, Statistic s = Statistic::mean, Share h = Share::all) const {
    return {at(a, 0, x, y, s, h), at(a, 1, x, y, s, h), at(a, 2, x, y, s, h)};
  }
  double samples(int x, int y) const { return at(Aov::color, 0, x, y, Statistic::samples); }
  // In the picture, not sky, and all of it finite.
  bool valid(int x, int y) const { return inside(x, y) && valid_[index(x, y)]; }
  // The direction of the mean normal; (0, 0, 0) if it has none. The filter takes normals.
  const Rgb& unit_normal(int x, int y) const { return normals_[index(x, y)]; }

 private:
  bool finite_and_no_sky(int x, int y) const;
  Rgb direction(const Rgb& mean_normal) const;

  int first_plane(Aov a, Statistic s, Share h) const {
    return first_plane_[static_cast<int>(a)][static_cast<int>(s)][static_cast<int>(h)];
  }

  const Image& input_;
  std::vector<Channel> inputs_;
  int first_plane_[kAovs][4][3];  // -1: not taken
  std::vector<bool> valid_;
  std::vector<Rgb> normals_;
};

double luminance(const Rgb&);
double squared(const Rgb&);
Rgb difference(const Rgb&, const Rgb&);
Rgb floored(const Rgb& albedo);
// The B3 spline's weight at offset -2 .. 2.
double b3(int offset);

}  // namespace tessera::reference
