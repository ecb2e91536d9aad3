// SPDX-License-Identifier: Apache-2.0
// Where a pixel's surface was one frame before (Schied et al. 2017, section 4.1): what the references of all
// filters with history share.
#pragma once

#include <functional>
#include <vector>

#include "tests/reference/features.h"

namespace tessera::reference {

// A pixel of the frame before and its weight.
struct PastPixel {
  int x, y;
  double weight;
};

// Those whose weighted mean is what (x, y) was. None: it was not seen. `taken`: whether (qx, qy), which
// lies in `past`, shows the same. `wide`: if none of the four around does, those of nine that do.
std::vector<PastPixel> past_pixels(const Features&, const Region& past, int x, int y,
                                   const std::function<bool(int qx, int qy)>& taken, bool wide = true);

// The mean of value(x, y) over them; 0 of none.
template <typename Value>
double mean(const std::vector<PastPixel>& pixels, const Value& value) {
  double sum = 0, total = 0;
  for (const PastPixel& p : pixels) {
    sum += p.weight;
    total += p.weight * value(p.x, p.y);
  }
  return pixels.empty() ? 0 : total / sum;
}
double mean_of_plane(const std::vector<PastPixel>&, const Image& past, int plane);

// The test by depth, normal and object, against five planes of `past` from `first` on.
bool same_surface(const Features&, int x, int y, const Image& past, int first, int qx, int qy);

// The length of the history, from the plane `plane` of the one before. What is no length counts as 0.
double plausible_length(float);
double history_length(const Image& past, int plane, const std::vector<PastPixel>&);

// By the parameters alpha (by the name given) and average.
double weight_of_now(const FilterPlan&, std::string_view alpha, double length);

// The five planes that same_surface() compares, at (x, y).
std::vector<double> trace(const Features&, int x, int y);

}  // namespace tessera::reference
