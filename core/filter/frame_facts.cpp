// SPDX-License-Identifier: Apache-2.0
// What a frame's files tell of its scene.
#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <limits>

#include "core/filter/gather.h"
#include "core/layers.h"

namespace tessera {
namespace {

// 0: it is not written there, or is none.
double written(const ExrImage& picture, const std::string& key) {
  const auto* text = picture.about<std::string>(key);
  double value = 0;
  if (!text || std::from_chars(text->data(), text->data() + text->size(), value).ec != std::errc{}) return 0;
  return std::isfinite(value) && value > 0 ? value : 0;
}

class Depths {
 public:
  Depths(const FilterPlan& plan, const Image& input) {
    const std::vector<Channel> inputs = plan.inputs();
    const auto at = std::ranges::find(inputs, Channel{Aov::depth, 0});
    if (at != inputs.end()) depths_ = input.plane(static_cast<int>(at - inputs.begin()));
  }
  bool is_sky(std::size_t i) const { return !depths_.empty() && depths_[i] >= kSkyDepth; }
  double largest() const {
    double farthest = 0;
    for (const float z : depths_)
      if (z < kSkyDepth) farthest = std::max(farthest, double(z));
    return farthest;
  }

 private:
  std::span<const float> depths_;
};

// A channel of P, of the frame or of a file of its own; empty: there is none.
std::span<const float> positions(const Sources& sources, int c) {
  const Channel channel{Aov::position, c};
  if (const auto at = sources.separate.find(layer_of(channel)); at != sources.separate.end())
    if (const auto plane = find_plane_alone(at->second, channel))
      return at->second.pixels.plane(plane->number);
  const auto plane = find_plane(*sources.picture, channel);
  return plane ? sources.picture->pixels.plane(plane->number) : std::span<const float>();
}

// The diagonal of what P holds; 0 if there is none.
double diagonal(const Depths& depths, const Sources& sources) {
  double squares = 0;
  for (int c = 0; c < 3; ++c) {
    float low = std::numeric_limits<float>::max(), high = std::numeric_limits<float>::lowest();
    const auto plane = positions(sources, c);
    for (std::size_t i = 0; i < plane.size(); ++i) {
      if (depths.is_sky(i) || !std::isfinite(plane[i])) continue;
      low = std::min(low, plane[i]);
      high = std::max(high, plane[i]);
    }
    if (high > low) squares += (double(high) - low) * (double(high) - low);
  }
  return std::sqrt(squares);
}

bool asks_for(const FilterPlan& plan, SceneFact fact) {
  return std::ranges::any_of(plan.description().parameters, [&](const Parameter& p) {
    return p.fact == fact && plan.parameters.find(p.name)->second == 0;
  });
}

}  // namespace

bool asks_for_scene(const FilterPlan& plan) {
  return asks_for(plan, SceneFact::diameter) || asks_for(plan, SceneFact::light);
}

FoundFacts facts_of(const FilterPlan& plan, const Image& input, const Sources& sources) {
  FoundFacts found{
      {.diameter = written(*sources.picture, kDiameterKey), .light = written(*sources.picture, kLightKey)},
      {}};
  if (found.facts.light == 0 && asks_for(plan, SceneFact::light))
    found.notices.push_back(fmt::format(
        "the file does not say how bright the scene's emitters are: filter '{}' takes 1", plan.name));
  if (found.facts.diameter > 0) return found;
  const Depths depths(plan, input);
  const double across = diagonal(depths, sources);
  found.facts.diameter = across > 0 ? across : depths.largest();
  if (asks_for(plan, SceneFact::diameter))
    found.notices.push_back(fmt::format("the file does not say how large the scene is: {:.4g}, {}",
                                        found.facts.diameter,
                                        across > 0 ? "by what P holds" : "by the largest depth"));
  return found;
}

}  // namespace tessera
