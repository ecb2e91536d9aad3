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
#include "core/filter/broken_pixels.h"
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
    Gathered result{.input = Image(region_, static_cast<int>(channels.size()))};
    for (std::size_t k = 0; k < channels.size(); ++k) {
      Plane plane = find_or_replace(in_its_time(channels[k]));
      if (channels[k].aov == Aov::depth && channels[k].statistic == Statistic::mean) {
        count_no_depths(plane, result);
        mark_sky(plane);
      }
      if (channels[k].aov == Aov::previous_depth) mark_sky(plane);
      std::ranges::copy(plane, result.input.plane(static_cast<int>(k)).begin());
    }
    mend_motion_of(result);
    result.broken = broken_planes(plan_, result.input);
    break_whole_colors(plan_, result.input);
    result.notices = std::move(notices_);
    result.asked_for = std::move(asked_for_);
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

  std::optional<Plane> find(const Channel& c) {
    if (const auto own = separate(c)) return own;
    const auto plane = found_in(*sources_.picture, c);
    return plane ? std::optional(taken(*sources_.picture, *plane, c)) : std::nullopt;
  }
  std::optional<FilePlane> found_in(const ExrImage& file, const Channel& c, bool alone = false) const {
    const auto plane = alone ? find_plane_alone(file, c) : find_plane(file, c);
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

  // From a file of that layer: under the layer's name, or by its letters alone.
  std::optional<Plane> separate(const Channel& c) {
    const std::string layer = layer_of(c);
    asked_for_.insert(layer);
    const auto at = sources_.separate.find(layer);
    if (at == sources_.separate.end()) return std::nullopt;
    const ExrImage& file = at->second;
    if (file.pixels.region() != region_)
      throw InputError(layer, "its file covers other pixels than the picture", "files of one size and place");
    if (const auto plane = found_in(file, c, true)) return taken(file, *plane, c);
    throw InputError(layer, fmt::format("its file has no such layer; there are: {}", names_in(file)),
                     fmt::format("{}, or its letters alone", accepted_layers(c)));
  }
  static std::string names_in(const ExrImage& file) {
    std::vector<std::string> names;
    for (const ExrChannel& e : file.channels) names.push_back(e.name);
    return fmt::format("{}", fmt::join(names, ", "));
  }

  Plane find_or_replace(const Channel& c) {
    if (auto found = find(c)) return *std::move(found);
    if (auto other = replacement(c)) return *std::move(other);
    throw InputError(name_,
                     fmt::format("filter '{}' takes {}, which is not there; there are: {}", plan_.name,
                                 accepted_layers(c), names_in(*sources_.picture)),
                     accepted_instead(c));
  }
  std::string accepted_instead(const Channel& c) const {
    std::string text = fmt::format("a file with that layer, or --guide {}=FILE", layer_of(c));
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
          say(fmt::format("no layer {}: surfaces count as having been as deep as they are", layer_of(c)));
        return find_or_replace({Aov::depth, 0});
      case Aov::geometric_normal:
        say(fmt::format("no layer {}: the shading normals N stand in", layer_of(c)));
        return find_or_replace({Aov::normal, c.index});
      case Aov::object_id:
      case Aov::material_id:
        say(fmt::format("no layer {}: all surfaces count as one there", layer_of(c)));
        return zeros();
      case Aov::depth_gradient: {
        say(fmt::format("no layer {}: it is the difference of neighbouring depths", layer_of(c)));
        Image depth(region_, 1, find_or_replace({Aov::depth, 0}));
        mark_sky(depth.data());
        const Image slope = depth_differences(depth);
        return Plane(slope.plane(c.index).begin(), slope.plane(c.index).end());
      }
      default:
        return std::nullopt;
    }
  }

  void count_no_depths(const Plane& plane, Gathered& gathered) const {
    const auto bad = [](float z) { return std::isnan(z); };
    const auto count = std::ranges::count_if(plane, bad);
    if (count == 0) return;
    const auto first = static_cast<int>(std::ranges::find_if(plane, bad) - plane.begin());
    gathered.defects.push_back(
        fmt::format("{}: {} of {} pixels are no number, the first at ({}, {}): they count as sky",
                    layer_of({Aov::depth, 0}), count, region_.area(), region_.x0 + first % region_.width(),
                    region_.y0 + first / region_.width()));
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
                    layer_of(in_its_time(*at)), broken.count, region_.area(),
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

  bool halves() { return find({Aov::color, 0, Statistic::mean, Share::a}).has_value(); }

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
      say(fmt::format("no layer {}: {} counts as free of noise", layer_of(c), layer_of({c.aov, c.index})));
      return zeros();
    }
    if (c.aov == Aov::color) {
      if (auto of_samples = variance_of_samples(c)) return of_samples;
    } else if (is_one_light(c)) {
      return variance_of_one_light(c);
    }
    say(fmt::format("no layer {}: it is estimated from the picture, where detail counts as noise",
                    layer_of(c)));
    Image mean(region_, 1, find_or_replace({c.aov, c.index}));
    return std::move(estimated_variance(mean)).release();
  }

  // What is known of one sample, as that of the mean.
  std::optional<Plane> variance_of_samples(const Channel& c) {
    const auto at = find_variance_of_samples(*sources_.picture, c);
    if (!at) return std::nullopt;
    const auto n = find(kSampleCount) ? find(kSampleCount) : samples(kSampleCount);
    if (!n) {
      say("Variance is that of single samples, and there is no telling how many a pixel has: --samples N "
          "says it");
      return std::nullopt;
    }
    Plane variance = taken(*sources_.picture, *at, c);
    for (std::size_t i = 0; i < variance.size(); ++i) variance[i] /= std::max((*n)[i], 1.0f);
    return variance;
  }

  bool is_one_light(const Channel& c) {
    return !find({Aov::direct, c.index}) && !find({Aov::indirect, c.index});
  }
  // That of the picture, for direct light.
  Plane variance_of_one_light(const Channel& c) {
    if (c.aov == Aov::indirect) return zeros();
    return find_or_replace({Aov::color, c.index, Statistic::variance_of_mean});
  }
  // All light but the emission as direct light.
  std::optional<Plane> one_light(const Channel& c) {
    if (!is_one_light(c)) return std::nullopt;
    say("no layers direct and indirect: their light is filtered as one");
    if (c.aov == Aov::indirect) return zeros();
    Plane light = find_or_replace({Aov::color, c.index});
    if (const auto emission = find({Aov::emission, c.index}))
      for (std::size_t i = 0; i < light.size(); ++i) light[i] -= (*emission)[i];
    return light;
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
  std::set<std::string> said_, asked_for_;
  std::vector<std::string> notices_;
};

}  // namespace

Gathered gather(const FilterPlan& plan, const Sources& sources, const std::string& name_of_picture) {
  return Gatherer(plan, sources, name_of_picture).gather();
}

}  // namespace tessera
