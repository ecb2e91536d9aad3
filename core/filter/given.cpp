// SPDX-License-Identifier: Apache-2.0
#include "core/filter/given.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/layers.h"

namespace tessera {
namespace {

std::string words_for(const Region& r) { return fmt::format("{} {} to {} {}", r.x0, r.y0, r.x1, r.y1); }

}  // namespace

ExrImage given_file(const FilterPlan& plan, Image input, const Region& display) {
  ExrImage file;
  file.display = display;
  for (const Channel& c : plan.inputs()) file.channels.push_back({file_channel(c), ExrType::float32});
  file.pixels = std::move(input);
  return file;
}

Image given_planes(const FilterPlan& plan, const ExrImage& file, const Region& region,
                   const std::string& name) {
  if (file.pixels.region() != region)
    throw InputError(name, "covers the pixels " + words_for(file.pixels.region()), words_for(region));
  const std::vector<Channel> channels = plan.inputs();
  Image input(region, static_cast<int>(channels.size()));
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const int plane = file.plane(file_channel(channels[k]));
    if (plane < 0)
      throw InputError(name, fmt::format("has no channel {}", file_channel(channels[k])),
                       fmt::format("what {} takes", plan.name));
    std::ranges::copy(file.pixels.plane(plane), input.plane(static_cast<int>(k)).begin());
  }
  if (file.pixels.planes() != input.planes())
    throw InputError(name, fmt::format("has {} channels", file.pixels.planes()),
                     fmt::format("the {} that {} takes", input.planes(), plan.name));
  return input;
}

}  // namespace tessera
