// SPDX-License-Identifier: Apache-2.0
#include "coordinator/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

namespace tessera {
namespace {

class Layers {
 public:
  Layers(const Job& job, const Region& region) : region_(region) {
    exr_.display = {0, 0, job.render.size.width, job.render.size.height};
  }

  void add(const std::string& name, std::span<const float> plane, bool half) {
    exr_.channels.push_back({name, half});
    data_.insert(data_.end(), plane.begin(), plane.end());
  }
  // Planes 0, 1, … of `image` as layer.C for each letter C.
  void add(std::string_view layer, std::string_view letters, const Image& image, bool half) {
    for (std::size_t c = 0; c < letters.size(); ++c)
      add(layer.empty() ? std::string(1, letters[c]) : fmt::format("{}.{}", layer, letters[c]),
          image.plane(static_cast<int>(c)), half);
  }

  ExrImage finished() && {
    exr_.pixels = Image(region_, static_cast<int>(exr_.channels.size()), std::move(data_));
    return std::move(exr_);
  }
  ExrImage& exr() { return exr_; }

 private:
  Region region_;
  ExrImage exr_;
  std::vector<float> data_;
};

Image sum_of_halves(const Image& sums, int plane_a) {
  Image both(sums.region(), 1);
  for (std::size_t i = 0; i < both.data().size(); ++i)
    both.data()[i] = sums.plane(plane_a)[i] + sums.plane(plane_a + 1)[i];
  return both;
}

Image coverage(const FrameImage& frame, const Image& samples) {
  Image alpha = sum_of_halves(frame.sums, FilmLayout::hits(Half::a));
  for (std::size_t i = 0; i < alpha.data().size(); ++i)
    alpha.data()[i] = samples.data()[i] > 0 ? alpha.data()[i] / samples.data()[i] : 0.0f;
  return alpha;
}

Image error_map(const FrameImage& frame) {
  Image map(frame.sums.region(), 1, std::numeric_limits<float>::infinity());  // where nothing is known yet
  for (std::size_t c = 0; c < frame.states.size(); ++c)
    paste(map, Image(frame.cells[c], 1, static_cast<float>(frame.states[c].error.mean)));
  return map;
}

void add_guides(Layers& layers, const FrameImage& frame) {
  for (int a = 1; a < kAovs; ++a) {
    const AovInfo& i = info(static_cast<Aov>(a));
    if (!frame.layout.aovs().has(i.aov)) continue;
    const bool half = i.aov != Aov::depth && i.aov != Aov::position;
    layers.add(i.name, i.channels, developed(frame.sums, frame.layout, channels_of(i.aov), Part::all), half);
  }
}

void add_metadata(ExrImage& exr, const Job& job, const FrameImage& frame, const Provenance& from,
                  const Image& samples) {
  auto& m = exr.metadata;
  const auto [least, most] = std::minmax_element(samples.data().begin(), samples.data().end());
  m["tessera/version"] = from.version;
  m["tessera/scene"] = from.scene_hash;
  m["tessera/samples"] =
      fmt::format("{:.0f} {:.2f} {:.0f}", *least,
                  static_cast<double>(frame.pixel_samples) / samples.region().area(), *most);
  m["tessera/error"] = verdict(job, frame);
  m["tessera/filter"] = to_string(job.filter);
  m["tessera/seed"] = fmt::format("{}", job.render.seed);
  m["tessera/frame"] = job.frame;
  m["tessera/tile"] = fmt::format("{}x{}", job.tile.width, job.tile.height);
  m["tessera/device"] = from.device;
  m["tessera/seconds"] = static_cast<float>(from.seconds);
  if (from.dropped > 0) m["tessera/dropped"] = fmt::format("{} samples were not finite", from.dropped);
  if (frame.rounds > 0) {
    m["tessera/relmse"] = static_cast<float>(frame.error.mean);
    m["tessera/relmse_upper"] = static_cast<float>(frame.error.upper(kTwoLooks));
  }
}

}  // namespace

ExrImage layered(const Job& job, const FrameImage& frame, const Provenance& from) {
  Layers layers(job, frame.sums.region());
  const Image samples = sum_of_halves(frame.sums, FilmLayout::count(Half::a));
  layers.add("", "RGB", frame.filtered, true);
  layers.add("A", coverage(frame, samples).plane(0), true);
  layers.add("noisy", "RGB", developed(frame.sums, frame.layout, channels_of(Aov::color), Part::all), true);
  layers.add(
      "variance", "RGB",
      developed(frame.sums, frame.layout, channels_of(Aov::color, Statistic::variance_of_mean), Part::all),
      false);
  layers.add("samples.Y", samples.plane(0), false);
  layers.add("error.Y", error_map(frame).plane(0), false);
  add_guides(layers, frame);
  add_metadata(layers.exr(), job, frame, from, samples);
  return std::move(layers).finished();
}

std::string verdict(const Job& job, const FrameImage& frame) {
  const std::string why = frame.stop ? std::string(to_string(*frame.stop)) : "in progress";
  if (frame.rounds == 0) return fmt::format("{}: no complete round, the image is the noisy one", why);
  std::string text = fmt::format("{}: relMSE {:.3e} estimated, {:.3e} upper bound (95%)", why,
                                 frame.error.mean, frame.error.upper(kTwoLooks));
  if (job.acceptance.relmse)
    text += fmt::format(", target {:.3e} per cell, met by {:.1f}% of the cells", *job.acceptance.relmse,
                        100 * frame.acceptable_share);
  return text;
}

}  // namespace tessera
