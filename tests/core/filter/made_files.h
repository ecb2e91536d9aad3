// SPDX-License-Identifier: Apache-2.0
// Files for the tests of what is gathered from files.
#pragma once

#include <algorithm>
#include <string>
#include <vector>

#include "core/filter/gather.h"
#include "core/layers.h"

namespace tessera {

inline constexpr Region kRegion{2, 3, 9, 8};

inline int plane_of(const ExrImage& file, const Channel& c) {
  const auto plane = find_plane(file, c);
  return plane ? plane->number : -1;
}

// A file whose channel number i is i + 1 everywhere.
inline ExrImage file(const std::vector<std::string>& names) {
  ExrImage image;
  image.display = kRegion;
  image.pixels = Image(kRegion, static_cast<int>(names.size()));
  for (std::size_t i = 0; i < names.size(); ++i) {
    image.channels.push_back({names[i], ExrType::float32});
    std::ranges::fill(image.pixels.plane(static_cast<int>(i)), static_cast<float>(i + 1));
  }
  return image;
}

inline float first_of(const FilterPlan& plan, const Image& input, const Channel& c) {
  const std::vector<Channel> inputs = plan.inputs();
  return input.plane(static_cast<int>(std::ranges::find(inputs, c) - inputs.begin()))[0];
}

}  // namespace tessera
