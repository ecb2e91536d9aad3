// SPDX-License-Identifier: Apache-2.0
#include "cli/walk.h"

#include <fmt/format.h>

#include <algorithm>

#include "cli/sizes.h"
#include "core/error.h"
#include "core/filter/history.h"

namespace tessera {
namespace {

constexpr int kLeastTile = 16;

// The history is counted as it is where everything rests; where pixels of a tile come from far apart, it is
// larger.
std::uint64_t bytes_of(const FilterPlan& plan, const Region& frame, Size tile) {
  const int halo = plan.halo();
  const double width = std::min(tile.width + 2 * halo, frame.width());
  const double height = std::min(tile.height + 2 * halo, frame.height());
  const double floats = static_cast<double>(plan.inputs().size()) +
                        plan.description().scratch(plan.parameters) + 3 + 2 * plan.history();
  return static_cast<std::uint64_t>(width * height * floats * sizeof(float));
}

Size tile_of(const DenoiseOptions& o, const FilterPlan& plan, const Region& frame) {
  return o.tile_size.empty() ? tile_within(plan, frame, o.memory << 20) : tile_size_option(o.tile_size);
}

// The planes of motion that the filter takes.
Image motion_of(const FilterPlan& plan, const Image& input) {
  const std::vector<Channel> channels = plan.inputs();
  const auto at = std::ranges::find(channels, Channel{Aov::motion, 0});
  return planes_of(input, static_cast<int>(at - channels.begin()), 2);
}

Image filtered(Device& device, const FilterPlan& plan, const Image& input, Size tile, const Image& history) {
  const Region& frame = input.region();
  const Image motion = history.empty() ? Image{} : motion_of(plan, input);
  Image whole(frame, 3 + plan.history());
  for (const Tile& t : tiles_over(frame, tile, plan.halo())) {
    const Image before = touched(history, motion, t.outer, frame);
    Image tile_result = filter(device, plan, cropped(input, t.outer), t, frame, before);
    paste(whole, tile_result);
    recycle(device, std::move(tile_result));
  }
  return whole;
}

}  // namespace

void Walk::failed(int number) {
  succession_.failed(number);
  kept_ = {};
}

FilteredFrame Walk::next(const NoisyFrame& frame, int number) {
  FilteredFrame result;
  result.tile = tile_of(options_, frame.plan, frame.region());
  Succession before = succession_;
  const Succession::Link link = before.next(number, frame.region(), frame.picture.display);
  const Image history = link.goes_on ? std::move(kept_) : Image{};
  failed(number);  // until it is done
  result.image = filtered(device_, frame.plan, frame.gathered.input, result.tile, history);
  succession_ = before;
  if (frame.plan.history() == 0) return result;
  result.cut = link.cut;
  kept_ = planes_of(result.image, 3, frame.plan.history());
  return result;
}

Size tile_within(const FilterPlan& plan, const Region& frame, std::uint64_t bytes, Size most) {
  Size tile{std::min(frame.width(), most.width), std::min(frame.height(), most.height)};
  while (bytes_of(plan, frame, tile) > bytes) {
    int& longer = tile.width > tile.height ? tile.width : tile.height;
    if (longer <= kLeastTile)
      throw Error(
          ExitCode::out_of_memory,
          fmt::format("--memory: filter '{}' takes {} MiB for a tile of {}x{} with its halo of {}", plan.name,
                      (bytes_of(plan, frame, tile) >> 20) + 1, tile.width, tile.height, plan.halo()));
    longer = (longer + 1) / 2;
  }
  return tile;
}

}  // namespace tessera
