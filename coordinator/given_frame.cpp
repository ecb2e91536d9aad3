// SPDX-License-Identifier: Apache-2.0
#include "coordinator/given_frame.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <initializer_list>

#include "core/error.h"

namespace tessera {
namespace {

constexpr int kColors = 3;

// Where the plane of that channel is among those that the filter takes; -1: it does not take it.
int place_of(const Channel& channel, const std::vector<Channel>& channels) {
  const auto at = std::ranges::find(channels, channel);
  return at == channels.end() ? -1 : static_cast<int>(at - channels.begin());
}

// The sum of these layers, as far as the filter takes them.
void add_layers(Image& sum, const Image& planes, const std::vector<Channel>& channels,
                std::initializer_list<Aov> layers) {
  for (const Aov layer : layers)
    for (int c = 0; c < kColors; ++c) {
      const int plane = place_of({layer, c}, channels);
      if (plane < 0) continue;
      std::ranges::transform(sum.plane(c), planes.plane(plane), sum.plane(c).begin(), std::plus<>());
    }
}

// RGB, before it is filtered; black, if the filter takes nothing of it.
Image noisy(const Image& planes, const std::vector<Channel>& channels) {
  Image picture(planes.region(), kColors);
  if (place_of({Aov::color, 0}, channels) >= 0)
    add_layers(picture, planes, channels, {Aov::color});
  else
    add_layers(picture, planes, channels, {Aov::direct, Aov::indirect, Aov::emission});
  return picture;
}

}  // namespace

GivenFrame::GivenFrame(const Job& job, Planes planes, bool awaits_history)
    : Frame(job, awaits_history),
      planes_(std::move(planes)),
      stitched_(job.region(), filter_shape(job).answer) {
  if (planes_ && (planes_->region() != job.region() || planes_->planes() != filter_shape(job).taken))
    throw InputError("frame", "is given other planes than its filter takes", "those of its job");
  for (const Tile& tile : plan_tiles(job)) open_.emplace(tile.inner, tile);
  tiles_ = static_cast<int>(open_.size());
}

GivenFrame::GivenFrame(const Job& job, Planes planes, const FrameSnapshot& snapshot)
    : GivenFrame(job, std::move(planes), true) {
  if (snapshot.round != 1 || !snapshot.have.empty() || !snapshot.want.empty())
    throw InputError("snapshot of a frame", "is of one that is rendered");
}

// The planes twice, as they are read; the stitched ones, a copy to write, and what was kept before and after.
double GivenFrame::bytes(const Job& job) {
  const FilterShape shape = filter_shape(job);
  return static_cast<double>(job.region().area()) * sizeof(float) *
         (2 * shape.taken + shape.answer + kColors + 2 * shape.kept);
}

std::vector<Work> GivenFrame::tasks() const {
  std::vector<Work> tasks;
  if (!planes_) return tasks;
  for (const auto& [inner, tile] : open_) tasks.emplace_back(FilterTask{tile, round()});
  return tasks;
}

std::vector<Work> GivenFrame::outstanding() const {
  return stopped() || awaits_history() ? std::vector<Work>{} : tasks();
}

void GivenFrame::stitch(const FilterTask& task, const Filtered& filtered) {
  const auto tile = open_.find(task.tile.inner);
  if (stopped() || tile == open_.end()) return;
  paste(stitched_, filtered);
  open_.erase(tile);
}

std::vector<Work> GivenFrame::look(const Budget&) {
  assert(round_complete());
  stop(StopReason::filtered);
  return {};
}

std::shared_ptr<const Image> GivenFrame::kept() const {
  assert(stopped());
  return std::make_shared<const Image>(planes_of(stitched_, kColors, filter_shape(job()).kept));
}

Image GivenFrame::motion(const Image& taken) const {
  return planes_of(taken, place_of({Aov::motion, 0}, job().filter.inputs()), 2);
}

Image GivenFrame::preview() const {
  Image shown = planes_of(stitched_, 0, kColors);
  if (!planes_ || open_.empty()) return shown;
  const Image picture = noisy(*planes_, job().filter.inputs());
  for (const auto& [inner, tile] : open_) paste(shown, cropped(picture, inner));
  return shown;
}

FrameImage GivenFrame::image() const& {
  FrameImage image;
  image.filtered = preview();
  image.stop = stop_;
  return image;
}

Progress GivenFrame::progress(double seconds) const {
  Progress p{.round = round(), .tiles_round = tiles_, .seconds = seconds};
  p.tiles_done = tiles_ - static_cast<int>(open_.size());
  const double done = static_cast<double>(p.tiles_done) / tiles_;
  p.fraction = stopped() ? 1.0 : std::min(0.999, done);
  if (done > 0 && !stopped()) p.seconds_left = seconds * (1 - done) / done;
  return p;
}

}  // namespace tessera
