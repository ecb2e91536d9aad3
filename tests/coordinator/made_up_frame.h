// SPDX-License-Identifier: Apache-2.0
// A renderer and a filter that need no scene and no device, to drive frames in tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "coordinator/rendered_frame.h"
#include "core/filter/filter.h"
#include "core/sha256.h"

namespace tessera {

// SplitMix64 (Steele et al. 2014), to [0, 1).
inline float uniform(std::uint64_t key) {
  std::uint64_t z = key * 0x9e3779b97f4a7c15u + 0x9e3779b97f4a7c15u;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return static_cast<float>((z ^ (z >> 31)) >> 40) * 0x1p-24f;
}

// A made-up renderer: grey noise around a ramp, a function of pixel and sample alone, summed as the contract
// says.
inline Block leaf(const Region& region, int begin, const FilmLayout& layout, float noise) {
  Block block{{begin, begin + kLeafSamples}, Image(region, layout.planes())};
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x)
      for (int s = begin; s < begin + kLeafSamples; ++s) {
        const float u = uniform((std::uint64_t(s) << 40) + (std::uint64_t(y) << 20) + x);
        const float value = 0.5f + 0.002f * static_cast<float>(x + y) + noise * (u - 0.5f);
        const Half half = s % 2 == 0 ? Half::a : Half::b;
        block.sums.at(FilmLayout::count(half), x, y) += 1;
        block.sums.at(FilmLayout::hits(half), x, y) += 1;
        for (const Aov aov : {Aov::color, Aov::direct})  // all of it is direct light
          for (int c = 0; layout.aovs().has(aov) && c < 3; ++c) {
            block.sums.at(layout.sum(aov, c, half), x, y) += value;
            block.sums.at(layout.square(aov, c, half), x, y) += value * value;
          }
      }
  return block;
}

inline Block rendered(const RenderTask& task, const FilmLayout& layout, float noise) {
  if (task.samples.count() == kLeafSamples) return leaf(task.region, task.samples.begin, layout, noise);
  const int middle = task.samples.begin + task.samples.count() / 2;
  Block block = rendered({task.region, {task.samples.begin, middle}}, layout, noise);
  join(block, rendered({task.region, {middle, task.samples.end}}, layout, noise), layout);
  return block;
}

// A frame that is given, whose corner is not the picture's, and its planes, each pixel's another one.
inline Job given_job(const std::string& filter) {
  Job job;
  job.filter = parse_filter(filter);
  job.given = Given{.planes = sha256("planes"), .display = {0, 0, 90, 60}, .goes_on = true};
  job.crop = Region{-5, -3, 95, 60};
  job.tile = {32, 16};
  return job;
}
inline Planes given_planes_of(const Job& job) {
  Image planes(job.region(), filter_shape(job).taken);
  const std::vector<Channel> channels = job.filter.inputs();
  for (std::size_t k = 0; k < channels.size(); ++k)
    for (std::size_t i = 0; i < planes.plane(0).size(); ++i)
      planes.plane(static_cast<int>(k))[i] =
          channels[k].aov == Aov::motion ? 1.0f : uniform((std::uint64_t(k) << 32) + i);
  return std::make_shared<const Image>(std::move(planes));
}

// A made-up filter of those: what it keeps is the next planes, half of what was there before where that is
// known.
inline Filtered filtered_given(const FilterTask& task, const FilterInput& input, const Job& job) {
  Filtered out = planes_of(cropped(input.film, task.tile.inner), 0, filter_shape(job).answer);
  if (input.history.empty()) return out;
  const Region& box = input.history.region();
  for (int p = 3; p < out.planes(); ++p)
    for (int y = out.region().y0; y < out.region().y1; ++y)
      for (int x = out.region().x0; x < out.region().x1; ++x)
        if (box.contains(x, y)) {
          float& kept = out.at(p, x, y);
          kept += 0.5f * (input.history.at(p - 3, x, y) - kept);
          out.at((p - 3) % 3, x, y) = kept;
        }
  return out;
}

// A made-up filter: none at all; of a temporal one, half of what was there before, which is all it keeps.
inline Filtered filtered(const FilterTask& task, const FilterInput& input, const Job& job) {
  if (job.given) return filtered_given(task, input, job);
  const FilmLayout layout(filter_aovs(job));
  const Aov light = layout.aovs().has(Aov::color) ? Aov::color : Aov::direct;
  Filtered out(task.tile.inner, filtered_planes(job.filter));
  const Image inner = cropped(input.film, task.tile.inner);
  int plane = 0;
  for (const Part part : {Part::all, Part::a, Part::b}) {
    const Image image = developed(inner, layout, channels_of(light), part);
    for (int c = 0; c < 3; ++c, ++plane)
      std::copy(image.plane(c).begin(), image.plane(c).end(), out.plane(plane).begin());
  }
  for (int kept = 0; plane < out.planes(); ++kept, ++plane)
    for (int y = inner.region().y0; y < inner.region().y1; ++y)
      for (int x = inner.region().x0; x < inner.region().x1; ++x) {
        float& delivered = out.at(kept % kFilteredPlanes, x, y);
        if (!input.history.empty()) delivered += 0.5f * (input.history.at(kept, x, y) - delivered);
        out.at(plane, x, y) = delivered;
      }
  return out;
}

}  // namespace tessera
