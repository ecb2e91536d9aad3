// SPDX-License-Identifier: Apache-2.0
// A renderer and a filter that need no scene and no device, to drive frames in tests.
#pragma once

#include <algorithm>
#include <cstdint>

#include "coordinator/frame.h"

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
        for (int c = 0; c < 3; ++c) {
          block.sums.at(layout.sum(Aov::color, c, half), x, y) += value;
          block.sums.at(layout.square(Aov::color, c, half), x, y) += value * value;
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

// A made-up filter: none at all; of a temporal one, half of what was there before, which is all it keeps.
inline Filtered filtered(const FilterTask& task, const FilterInput& input, const Job& job,
                         const FilmLayout& layout) {
  Filtered out(task.tile.inner, filtered_planes(job.filter));
  const Image inner = cropped(input.film, task.tile.inner);
  int plane = 0;
  for (const Part part : {Part::all, Part::a, Part::b}) {
    const Image image = developed(inner, layout, channels_of(Aov::color), part);
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
