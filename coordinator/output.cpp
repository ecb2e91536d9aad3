// SPDX-License-Identifier: Apache-2.0
#include "coordinator/output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>

#include "core/cryptomatte.h"
#include "core/filter/gather.h"
#include "core/layers.h"

namespace tessera {
namespace {

constexpr std::size_t kAtOnce =
    8;  // planes that are developed: they share a pass, and need room beside the film

class Layers {
 public:
  explicit Layers(const Job& job) : region_(job.region()) {
    const Size size = job.render.size;
    exr_.display = job.given ? job.given->display : Region{0, 0, size.width, size.height};
  }

  // So many planes will come.
  void reserve(int planes) { data_.reserve(static_cast<std::size_t>(region_.area()) * planes); }
  void remove(const std::string& name) {
    const auto at = std::ranges::find(exr_.channels, name, &ExrChannel::name);
    if (at == exr_.channels.end()) return;
    const auto area = static_cast<std::ptrdiff_t>(region_.area());
    const auto first = data_.begin() + (at - exr_.channels.begin()) * area;
    data_.erase(first, first + area);
    exr_.channels.erase(at);
  }
  void add(const std::string& name, std::span<const float> plane, bool half) {
    exr_.channels.push_back({name, half ? ExrType::half : ExrType::float32});
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
  Floats data_;
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

std::string layer_name(Aov a, const Provenance& from) {
  if (!is_light_group(static_cast<int>(a))) return std::string(info(a).name);
  const auto g = static_cast<std::size_t>(a) - static_cast<std::size_t>(Aov::light_group);
  return g < from.light_groups.size() ? "light_" + from.light_groups[g] : std::string(info(a).name);
}

// Ranks two to a layer: CryptoObject00.R,G,B,A is id, coverage, id, coverage.
void add_matte(Layers& layers, const FrameImage& frame, Aov aov, const std::vector<std::string>& names) {
  const std::string name(info(aov).name);
  const Image ranks = matte(frame.sums, frame.layout, aov);
  for (int p = 0; p < ranks.planes(); ++p)
    layers.add(fmt::format("{}{:02}.{}", name, p / 4, "RGBA"[p % 4]), ranks.plane(p), false);
  for (auto& [key, text] : matte_metadata(name, names)) layers.exr().metadata[key] = text;
}

// Colours fit in halves; places, distances, numbers and statistics do not.
bool fits_half(Aov a, Statistic statistic) {
  const std::string_view letters = info(a).letters;
  return statistic == Statistic::mean && (letters == "RGB" || a == Aov::normal || a == Aov::bounce);
}

// Each under the name that core/layers.h gives it, or in a layer of another name.
void add_channels(Layers& layers, const FrameImage& frame, std::span<const Channel> channels,
                  std::string_view name = "") {
  for (; !channels.empty(); channels = channels.subspan(std::min(channels.size(), kAtOnce))) {
    const auto some = channels.first(std::min(channels.size(), kAtOnce));
    const Image image = developed(frame.sums, frame.layout, some, Part::all);
    for (int p = 0; const Channel& c : some) {
      const std::string channel =
          name.empty() ? file_channel(c) : fmt::format("{}.{}", name, channel_name(c.aov, c.index));
      layers.add(channel, image.plane(p++), fits_half(c.aov, c.statistic));
    }
  }
}

void add_guide(Layers& layers, const FrameImage& frame, Aov a, const std::string& name) {
  if (info(a).reduction == Reduction::per_sample) {
    for (const Share half : {Share::a, Share::b})
      add_channels(layers, frame, channels_of(a, Statistic::mean, half));
    return;
  }
  const bool own_name = name != info(a).name;  // a light group's
  add_channels(layers, frame, channels_of(a), own_name ? name : "");
  const int moments = frame.layout.moments(a);
  const bool known = a == Aov::direct || a == Aov::indirect;  // their squares serve the filters alone
  if (moments >= 2 && !known) add_channels(layers, frame, channels_of(a, Statistic::variance_of_mean));
  if (moments >= 3) add_channels(layers, frame, channels_of(a, Statistic::third_moment));
}

void add_guides(Layers& layers, const FrameImage& frame, const Provenance& from) {
  for (int i = 1; i < kAovs; ++i) {
    const auto a = static_cast<Aov>(i);
    if (!is_aov(i) || !frame.layout.aovs().has(a)) continue;
    if (info(a).reduction == Reduction::ranks)
      add_matte(layers, frame, a, a == Aov::object_matte ? from.objects : from.materials);
    else
      add_guide(layers, frame, a, layer_name(a, from));
  }
}

// What a filter takes, to all of its bits.
void add_input(Layers& layers, const FrameImage& frame, const Channel& c) {
  const std::string name = file_channel(c);
  layers.remove(name);
  layers.add(name, developed(frame.sums, frame.layout, std::array{c}, Part::all).plane(0), false);
}

void add_metadata(ExrImage& exr, const Job& job, const FrameImage& frame, const Provenance& from) {
  auto& m = exr.metadata;
  m["tessera/version"] = from.version;
  m["tessera/error"] = verdict(job, frame);
  m["tessera/filter"] = to_string(job.filter);
  m["tessera/frame"] = job.frame;
  if (!from.key.empty()) m["tessera/job"] = from.key;
  m["tessera/tile"] = fmt::format("{}x{}", job.tile.width, job.tile.height);
  m["tessera/device"] = from.device;
  m["tessera/seconds"] = static_cast<float>(from.seconds);
}

// What is known of a frame that was rendered.
void add_rendering(ExrImage& exr, const Job& job, const FrameImage& frame, const Provenance& from,
                   const Image& samples) {
  auto& m = exr.metadata;
  const auto [least, most] = std::minmax_element(samples.data().begin(), samples.data().end());
  m["tessera/scene"] = from.scene_hash;
  if (from.facts.diameter > 0) m[kDiameterKey] = fmt::format("{}", from.facts.diameter);
  if (from.facts.light > 0) m[kLightKey] = fmt::format("{}", from.facts.light);
  m["tessera/samples"] =
      fmt::format("{:.0f} {:.2f} {:.0f}", *least,
                  static_cast<double>(frame.pixel_samples) / samples.region().area(), *most);
  m["tessera/seed"] = fmt::format("{}", job.render.seed);
  const RenderSettings& r = job.render;
  if (!r.variant.empty()) m["tessera/variant"] = r.variant;
  if (r.clamp_direct > 0) m["tessera/clamp_direct"] = r.clamp_direct;
  if (r.clamp_indirect > 0) m["tessera/clamp_indirect"] = r.clamp_indirect;
  if (r.regularise > 0) m["tessera/regularise"] = r.regularise;
  if (from.dropped > 0) m["tessera/dropped"] = fmt::format("{} samples were not finite", from.dropped);
  if (frame.rounds > 0) {
    m["tessera/relmse"] = static_cast<float>(frame.error.mean);
    m["tessera/relmse_upper"] = static_cast<float>(frame.error.upper(kTwoLooks));
  }
}

void add_rendered(Layers& layers, const Job& job, const FrameImage& frame, const Provenance& from) {
  const Image samples = sum_of_halves(frame.sums, FilmLayout::count(Half::a));
  layers.reserve(frame.layout.planes());  // the film has two halves of most
  layers.add("", "RGB", frame.filtered, true);
  layers.add("A", coverage(frame, samples).plane(0), true);
  layers.add("noisy", "RGB", developed(frame.sums, frame.layout, channels_of(Aov::color), Part::all), true);
  layers.add(
      "variance", "RGB",
      developed(frame.sums, frame.layout, channels_of(Aov::color, Statistic::variance_of_mean), Part::all),
      false);
  layers.add("samples.Y", samples.plane(0), false);
  layers.add("error.Y", error_map(frame).plane(0), false);
  add_guides(layers, frame, from);
  for (const Channel& c : from.filter_inputs) add_input(layers, frame, c);
  add_rendering(layers.exr(), job, frame, from, samples);
}

}  // namespace

ExrImage layered(const Job& job, const FrameImage& frame, const Provenance& from) {
  Layers layers(job);
  if (job.given)
    layers.add("", "RGB", frame.filtered, false);  // who gave the frame has the rest
  else
    add_rendered(layers, job, frame, from);
  add_metadata(layers.exr(), job, frame, from);
  return std::move(layers).finished();
}

std::string verdict(const Job& job, const FrameImage& frame) {
  const std::string why = frame.stop ? std::string(to_string(*frame.stop)) : "in progress";
  if (job.given) return frame.stop == StopReason::filtered ? why : why + ": not all tiles are filtered";
  if (frame.rounds == 0) return fmt::format("{}: no complete round, the image is the noisy one", why);
  std::string text = fmt::format("{}: relMSE {:.3e} estimated, {:.3e} upper bound (95%)", why,
                                 frame.error.mean, frame.error.upper(kTwoLooks));
  if (job.acceptance.relmse)
    text += fmt::format(", target {:.3e} per cell, met by {:.1f}% of the cells", *job.acceptance.relmse,
                        100 * frame.acceptable_share);
  return text;
}

}  // namespace tessera
