// SPDX-License-Identifier: Apache-2.0
#include "core/filter/gather.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <set>

#include "core/error.h"
#include "core/filter/stand_ins.h"
#include "core/layers.h"

namespace tessera {
namespace {

using Plane = Floats;

class Gatherer {
 public:
  Gatherer(const FilterPlan& plan, const Sources& sources, const std::string& name)
      : plan_(plan), sources_(sources), name_(name), region_(sources.picture->pixels.region()) {}

  Gathered gather() {
    const std::vector<Channel> channels = plan_.inputs();
    Gathered result{Image(region_, static_cast<int>(channels.size())), {}, {}};
    for (std::size_t k = 0; k < channels.size(); ++k) {
      Plane plane = find_or_replace(in_its_time(channels[k]));
      if (channels[k].aov == Aov::depth && channels[k].statistic == Statistic::mean) mark_sky(plane);
      if (channels[k].aov == Aov::previous_depth) mark_sky(plane);
      std::ranges::copy(plane, result.input.plane(static_cast<int>(k)).begin());
    }
    mend_motion_of(result);
    result.notices = std::move(notices_);
    return result;
  }

 private:
  // Backwards in time a filter goes by what comes after.
  Channel in_its_time(Channel c) const {
    if (!sources_.backwards) return c;
    if (c.aov == Aov::motion) c.aov = Aov::next_motion;
    if (c.aov == Aov::previous_depth) c.aov = Aov::next_depth;
    return c;
  }

  std::optional<Plane> find(const Channel& c) const {
    if (const auto own = separate(c)) return own;
    const auto plane = found_in(*sources_.picture, c);
    return plane ? std::optional(taken(*sources_.picture, *plane, c)) : std::nullopt;
  }
  std::optional<FilePlane> found_in(const ExrImage& file, const Channel& c) const {
    const auto plane = find_plane(file, c);
    return plane || !sources_.motion_scale ? plane : find_motion_of_unknown_unit(file, c);
  }
  Plane taken(const ExrImage& file, FilePlane plane, const Channel& c) const {
    const auto values = file.pixels.plane(plane.number);
    Plane result(values.begin(), values.end());
    if (is_motion(c) && sources_.motion_scale)
      plane.scale = (*sources_.motion_scale)[static_cast<std::size_t>(c.index)];
    if (is_motion(c) && sources_.backwards) plane.scale = -plane.scale;
    if (plane.scale != 1) std::ranges::for_each(result, [&](float& v) { v *= plane.scale; });
    return result;
  }
  static bool is_motion(const Channel& c) { return c.aov == Aov::motion || c.aov == Aov::next_motion; }

  // From a file of that layer: under the layer's name, or as the file's own picture.
  std::optional<Plane> separate(const Channel& c) const {
    const std::string whole = file_channel(c);
    const std::string layer = whole.substr(0, whole.rfind('.'));
    const auto at = sources_.separate.find(layer);
    if (at == sources_.separate.end()) return std::nullopt;
    const ExrImage& file = at->second;
    if (file.pixels.region() != region_)
      throw InputError(layer, "its file covers other pixels than the picture", "files of one size and place");
    auto plane = found_in(file, c);
    if (!plane) plane = {file.plane(std::string(1, "RGB"[std::min(c.index, 2)]))};
    if (plane->number < 0) plane = {std::min(c.index, file.pixels.planes() - 1)};
    return taken(file, *plane, c);
  }

  Plane find_or_replace(const Channel& c) {
    if (auto found = find(c)) return *std::move(found);
    if (auto other = replacement(c)) return *std::move(other);
    std::vector<std::string> there;
    for (const ExrChannel& e : sources_.picture->channels) there.push_back(e.name);
    throw InputError(name_,
                     fmt::format("filter '{}' takes {}, which is not there; there are: {}", plan_.name,
                                 accepted_layers(c), fmt::join(there, ", ")),
                     accepted_instead(c));
  }
  std::string accepted_instead(const Channel& c) const {
    std::string text = fmt::format("a file with that layer, or --guide {}=FILE", layer(c));
    if (!is_motion(c)) return text;
    if (const auto other = find_motion_of_unknown_unit(*sources_.picture, c))
      text += fmt::format(", or --motion-scale, which says how to read {}",
                          sources_.picture->channels[static_cast<std::size_t>(other->number)].name);
    return text + ", or --static, if nothing moves";
  }

  std::optional<Plane> replacement(const Channel& c) {
    if (c.statistic == Statistic::samples) return samples(c);
    if (c.share != Share::all) return of_half(c);
    if (c.statistic == Statistic::variance_of_mean) return variance(c);
    if (c.statistic != Statistic::mean) return std::nullopt;
    if (c.aov == Aov::emission) {
      say("no layer emission: emitters that are seen are filtered with the rest");
      return zeros();
    }
    if (c.aov == Aov::direct || c.aov == Aov::indirect) return one_light(c);
    return of_surface(c);
  }

  // What temporal filters tell surfaces apart by.
  std::optional<Plane> of_surface(const Channel& c) {
    switch (c.aov) {
      case Aov::motion:
      case Aov::next_motion:
        return sources_.resting ? std::optional(zeros()) : std::nullopt;
      case Aov::previous_depth:
      case Aov::next_depth:
        if (!sources_.resting)
          say(fmt::format("no layer {}: surfaces count as having been as deep as they are", layer(c)));
        return find_or_replace({Aov::depth, 0});
      case Aov::geometric_normal:
        say(fmt::format("no layer {}: the shading normals N stand in", layer(c)));
        return find_or_replace({Aov::normal, c.index});
      case Aov::object_id:
      case Aov::material_id:
        say(fmt::format("no layer {}: all surfaces count as one there", layer(c)));
        return zeros();
      case Aov::depth_gradient: {
        say(fmt::format("no layer {}: it is the difference of neighbouring depths", layer(c)));
        Image depth(region_, 1, find_or_replace({Aov::depth, 0}));
        mark_sky(depth.data());
        const Image slope = depth_differences(depth);
        return Plane(slope.plane(c.index).begin(), slope.plane(c.index).end());
      }
      default:
        return std::nullopt;
    }
  }

  void mend_motion_of(Gathered& gathered) const {
    const std::vector<Channel> channels = plan_.inputs();
    const auto at = std::ranges::find(channels, Channel{Aov::motion, 0});
    if (at == channels.end()) return;
    const int plane = static_cast<int>(at - channels.begin());  // and y behind it
    const BrokenPixels broken = mend_motion({gathered.input.plane(plane), gathered.input.plane(plane + 1)});
    if (broken.count == 0) return;
    const int first = static_cast<int>(broken.first);
    gathered.defects.push_back(
        fmt::format("{}: {} of {} pixels lead nowhere, the first at ({}, {}): they start anew",
                    layer(in_its_time(*at)), broken.count, region_.area(),
                    region_.x0 + first % region_.width(), region_.y0 + first / region_.width()));
  }

  std::optional<Plane> samples(const Channel& c) {
    if (c.share != Share::all) {
      Plane all = find_or_replace(kSampleCount);
      if (halves()) std::ranges::for_each(all, [](float& n) { n /= 2; });
      return all;
    }
    if (sources_.samples) return Plane(area(), static_cast<float>(*sources_.samples));
    const auto* text = sources_.picture->about<std::string>("tessera/samples");
    double least = 0, mean = 0;
    if (!text || std::sscanf(text->c_str(), "%lf %lf", &least, &mean) != 2 || !(mean >= 1))
      return std::nullopt;
    return Plane(area(), static_cast<float>(mean));
  }

  bool halves() const { return find({Aov::color, 0, Statistic::mean, Share::a}).has_value(); }

  std::optional<Plane> of_half(const Channel& c) {
    Plane whole = find_or_replace({c.aov, c.index, c.statistic, Share::all});
    if (halves()) {  // of half as many samples
      if (c.statistic == Statistic::variance_of_mean) std::ranges::for_each(whole, [](float& v) { v *= 2; });
      return whole;
    }
    say("no layers noisy_even and noisy_odd: the picture is compared with itself where halves would be");
    return whole;
  }

  std::optional<Plane> variance(const Channel& c) {
    const bool light = c.aov == Aov::color || c.aov == Aov::direct || c.aov == Aov::indirect;
    if (!light) {
      say(fmt::format("no layer {}: {} counts as free of noise", layer(c), info(c.aov).name));
      return zeros();
    }
    say(fmt::format("no layer {}: it is estimated from the picture, where detail counts as noise", layer(c)));
    Image mean(region_, 1, find_or_replace({c.aov, c.index}));
    return std::move(estimated_variance(mean)).release();
  }

  // All light but the emission as direct light.
  std::optional<Plane> one_light(const Channel& c) {
    if (find({Aov::direct, c.index}) || find({Aov::indirect, c.index})) return std::nullopt;
    say("no layers direct and indirect: their light is filtered as one");
    if (c.aov == Aov::indirect) return zeros();
    Plane light = find_or_replace({Aov::color, c.index});
    if (const auto emission = find({Aov::emission, c.index}))
      for (std::size_t i = 0; i < light.size(); ++i) light[i] -= (*emission)[i];
    return light;
  }

  std::string layer(const Channel& c) const {
    const std::string whole = file_channel(c);
    return whole.substr(0, whole.rfind('.'));
  }
  void say(std::string what) {
    if (said_.insert(what).second) notices_.push_back(std::move(what));
  }
  std::size_t area() const { return static_cast<std::size_t>(region_.area()); }
  Plane zeros() const { return Plane(area(), 0.0f); }

  const FilterPlan& plan_;
  const Sources& sources_;
  const std::string& name_;
  Region region_;
  std::set<std::string> said_;
  std::vector<std::string> notices_;
};

}  // namespace

Gathered gather(const FilterPlan& plan, const Sources& sources, const std::string& name_of_picture) {
  return Gatherer(plan, sources, name_of_picture).gather();
}

SceneFacts facts_of(const FilterPlan& plan, const Image& input, const Sources& sources) {
  const std::vector<Channel> inputs = plan.inputs();
  const auto depth_at = std::ranges::find(inputs, Channel{Aov::depth, 0});
  const auto sky = [&](std::size_t i) {
    return depth_at != inputs.end() &&
           input.plane(static_cast<int>(depth_at - inputs.begin()))[i] >= kSkyDepth;
  };
  const ExrImage& picture = *sources.picture;
  std::array<float, 3> low, high;
  low.fill(std::numeric_limits<float>::max());
  high.fill(std::numeric_limits<float>::lowest());
  double farthest = 0;
  const auto area = static_cast<std::size_t>(input.region().area());
  for (int c = 0; c < 3; ++c) {
    const auto plane = find_plane(picture, {Aov::position, c});
    for (std::size_t i = 0; plane && i < area; ++i) {
      const float v = picture.pixels.plane(plane->number)[i];
      if (sky(i) || !std::isfinite(v)) continue;
      low[static_cast<std::size_t>(c)] = std::min(low[static_cast<std::size_t>(c)], v);
      high[static_cast<std::size_t>(c)] = std::max(high[static_cast<std::size_t>(c)], v);
    }
  }
  if (depth_at != inputs.end())
    for (std::size_t i = 0; i < area; ++i)
      if (!sky(i))
        farthest = std::max(farthest, double(input.plane(static_cast<int>(depth_at - inputs.begin()))[i]));
  double squares = 0;
  for (std::size_t c = 0; c < 3; ++c)
    if (high[c] > low[c]) squares += (double(high[c]) - low[c]) * (double(high[c]) - low[c]);
  return {.diameter = squares > 0 ? std::sqrt(squares) : farthest};
}

}  // namespace tessera
