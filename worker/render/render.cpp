// SPDX-License-Identifier: Apache-2.0
#include "worker/render/render.h"

#include <cassert>

#include "worker/render/float_modes.h"
#include "worker/render/integrator.h"

namespace tessera {
namespace {

using tracer::kBlockEdge;

// Copies what lies in the image's region.
void store(std::span<const tracer::Lane> sums, int x0, int y0, Image& image) {
  const Region part = intersect(image.region(), {x0, y0, x0 + kBlockEdge, y0 + kBlockEdge});
  for (int p = 0; p < image.planes(); ++p)
    for (int y = part.y0; y < part.y1; ++y)
      for (int x = part.x0; x < part.x1; ++x)
        image.at(p, x, y) =
            sums[static_cast<std::size_t>(p)][static_cast<std::size_t>((y - y0) * kBlockEdge + (x - x0))];
}

}  // namespace

Block render(const RenderScene& scene, const RenderSettings& settings, int frame, const Region& region,
             SampleRange samples, const std::atomic<bool>* cancel) {
  assert(is_dyadic(samples) && region.x0 >= 0 && region.y0 >= 0);
  const tracer::FlushToZero modes;
  const FilmLayout layout(settings.aovs);
  Block result{samples, Image(region, layout.planes())};
  tracer::Integrator integrator(scene, settings, frame);
  tracer::SampleSums sums(layout);
  tracer::SampleBlock block(settings.aovs);
  for (int y = region.y0 & -kBlockEdge; y < region.y1; y += kBlockEdge)
    for (int x = region.x0 & -kBlockEdge; x < region.x1; x += kBlockEdge) {
      const tracer::BlockKeys keys(settings.seed, frame, x, y);
      sums.clear();
      for (int s = samples.begin; s < samples.end; ++s) {
        if (s % kLeafSamples == 0 && cancel && cancel->load(std::memory_order_relaxed)) throw Cancelled{};
        integrator.trace(keys, s, block);
        sums.add(s, block);
      }
      store(sums.result(), x, y, result.sums);
    }
  return result;
}

std::uint64_t dropped(const Block& block) {
  double valid = 0;
  for (const Half h : {Half::a, Half::b})
    for (const float n : block.sums.plane(FilmLayout::count(h))) valid += n;
  const std::int64_t asked = block.sums.region().area() * block.samples.count();
  return static_cast<std::uint64_t>(asked - static_cast<std::int64_t>(valid));
}

}  // namespace tessera
