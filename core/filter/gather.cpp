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
#include "core/layers.h"

namespace tessera {
namespace {

constexpr float kFarthest = 1e10f;  // what Cycles writes where there is nothing

using Plane = std::vector<float>;

class Gatherer {
 public:
  Gatherer(const FilterPlan& plan, const Sources& sources, const std::string& name)
      : plan_(plan), sources_(sources), name_(name), region_(sources.picture->pixels.region()) {}

  Gathered gather() {
    const std::vector<Channel> channels = plan_.inputs();
    Gathered result{Image(region_, static_cast<int>(channels.size())), {}};
    for (std::size_t k = 0; k < channels.size(); ++k) {
      Plane plane = find_or_replace(channels[k]);
      if (channels[k].aov == Aov::depth && channels[k].statistic == Statistic::mean) mark_sky(plane);
      std::ranges::copy(plane, result.input.plane(static_cast<int>(k)).begin());
    }
    result.notices = std::move(notices_);
    return result;
  }

 private:
  std::optional<Plane> find(const Channel& c) const {
    if (const auto own = separate(c)) return own;
    const int plane = plane_of(*sources_.picture, c);
    if (plane < 0) return std::nullopt;
    const auto values = sources_.picture->pixels.plane(plane);
    return Plane(values.begin(), values.end());
  }

  // From a file of that layer: under the layer's name, or as the file's own picture.
  std::optional<Plane> separate(const Channel& c) const {
    const std::string whole = file_channel(c);
    const std::string layer = whole.substr(0, whole.rfind('.'));
    const auto at = sources_.separate.find(layer);
    if (at == sources_.separate.end()) return std::nullopt;
    const ExrImage& file = at->second;
    if (file.pixels.region() != region_)
      throw InputError(layer, "its file covers other pixels than the picture", "files of one size and place");
    int plane = plane_of(file, c);
    if (plane < 0) plane = file.plane(std::string(1, "RGB"[std::min(c.index, 2)]));
    if (plane < 0) plane = std::min(c.index, file.pixels.planes() - 1);
    const auto values = file.pixels.plane(plane);
    return Plane(values.begin(), values.end());
  }

  Plane find_or_replace(const Channel& c) {
    if (auto found = find(c)) return *std::move(found);
    if (auto other = replacement(c)) return *std::move(other);
    std::vector<std::string> there;
    for (const ExrChannel& e : sources_.picture->channels) there.push_back(e.name);
    throw InputError(name_,
                     fmt::format("filter '{}' takes {}, which is not there; there are: {}", plan_.name,
                                 accepted_layers(c), fmt::join(there, ", ")),
                     fmt::format("a file with that layer, or --guide {}=FILE",
                                 file_channel(c).substr(0, file_channel(c).rfind('.'))));
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
    return std::nullopt;
  }

  std::optional<Plane> samples(const Channel& c) {
    if (c.share != Share::all) {
      Plane all = find_or_replace(kSampleCount);
      if (halves()) std::ranges::for_each(all, [](float& n) { n /= 2; });
      return all;
    }
    if (sources_.samples) return Plane(area(), static_cast<float>(*sources_.samples));
    const auto& metadata = sources_.picture->metadata;
    const auto at = metadata.find("tessera/samples");
    if (at == metadata.end()) return std::nullopt;
    const auto* text = std::get_if<std::string>(&at->second);
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

  static void mark_sky(Plane& depth) {
    for (float& z : depth)
      if (!(std::abs(z) < kFarthest)) z = kSkyDepth;
  }

  std::string layer(const Channel& c) const {
    const std::string whole = file_channel(c);
    return whole.substr(0, whole.rfind('.'));
  }
  void say(std::string what) {
    if (said_.insert(what).second) notices_.push_back(std::move(what));
  }
  std::size_t area() const { return static_cast<std::size_t>(region_.area()); }
  Plane zeros() const { return Plane(area()); }

  const FilterPlan& plan_;
  const Sources& sources_;
  const std::string& name_;
  Region region_;
  std::set<std::string> said_;
  std::vector<std::string> notices_;
};

// The response at (x, y), the picture continued by its border pixels; scaled to the standard deviation of
// noise.
double response(const Image& picture, int plane, int x, int y) {
  constexpr int kMask[3][3] = {{1, -2, 1}, {-2, 4, -2}, {1, -2, 1}};
  const Region& r = picture.region();
  double sum = 0;
  for (int j = -1; j <= 1; ++j)
    for (int i = -1; i <= 1; ++i)
      sum += kMask[j + 1][i + 1] *
             double(picture.at(plane, std::clamp(x + i, r.x0, r.x1 - 1), std::clamp(y + j, r.y0, r.y1 - 1)));
  return std::isfinite(sum) ? sum / 6 : 0;
}

// Means over 7 along each row, then along each column, of what lies in the picture.
void average(Image& image, int plane) {
  const Region& r = image.region();
  for (const bool along_x : {true, false}) {
    Image to(r, 1);
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        double sum = 0;
        int count = 0;
        for (int k = -3; k <= 3; ++k) {
          const int qx = along_x ? x + k : x, qy = along_x ? y : y + k;
          if (!r.contains(qx, qy)) continue;
          sum += image.at(plane, qx, qy);
          ++count;
        }
        to.at(0, x, y) = static_cast<float>(sum / count);
      }
    std::ranges::copy(to.data(), image.plane(plane).begin());
  }
}

}  // namespace

Gathered gather(const FilterPlan& plan, const Sources& sources, const std::string& name_of_picture) {
  return Gatherer(plan, sources, name_of_picture).gather();
}

Image estimated_variance(const Image& picture) {
  Image variance(picture.region(), picture.planes());
  const Region& r = picture.region();
  for (int p = 0; p < picture.planes(); ++p) {
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double noise = response(picture, p, x, y);
        variance.at(p, x, y) = static_cast<float>(std::min(noise * noise, 1e30));
      }
    average(variance, p);
  }
  return variance;
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
    const int plane = plane_of(picture, {Aov::position, c});
    for (std::size_t i = 0; plane >= 0 && i < area; ++i) {
      const float v = picture.pixels.plane(plane)[i];
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
