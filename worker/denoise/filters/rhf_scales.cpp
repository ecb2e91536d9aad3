// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/filters/rhf_scales.h"

#include <cassert>

#include "core/filter/rhf.h"

namespace tessera {
namespace {

int half_down(int v) { return v >> 1; }
int half_up(int v) { return (v + 1) >> 1; }

Region coarser_grid(const Region& r) {
  return {half_down(r.x0), half_down(r.y0), half_up(r.x1), half_up(r.y1)};
}

// The coarser pixels from which `r` is interpolated: an odd pixel from four, an even one from its own.
Region interpolated_from(const Region& r) {
  return {half_down(r.x0) - 1, half_down(r.y0) - 1, half_down(r.x1) + 2, half_down(r.y1) + 2};
}

// The finer pixels that are averaged to `r`.
Region averaged_from(const Region& r) {
  const int far = RhfScale{1}.low_pass();
  return {2 * r.x0 - far, 2 * r.y0 - far, 2 * (r.x1 - 1) + far + 1, 2 * (r.y1 - 1) + far + 1};
}

// The picture's pixels of which a coarse scale's `r` is made.
[[maybe_unused]] Region made_from(const Region& r, const RhfScale& scale) {
  const int step = scale.step();
  return grown({step * r.x0, step * r.y0, step * (r.x1 - 1) + 1, step * (r.y1 - 1) + 1}, scale.low_pass());
}

}  // namespace

std::vector<RhfPart> rhf_parts(const FilterPlan& plan, const Tile& tile, const Region& frame) {
  const int radius = static_cast<int>(plan["radius"]), patch = static_cast<int>(plan["patch"]);
  const int covering = plan.is("average", "patches") ? patch : 0;
  std::vector<RhfPart> parts(static_cast<std::size_t>(plan["scales"]));
  parts[0].grid = frame;
  parts[0].merged = tile.inner;
  for (std::size_t s = 1; s < parts.size(); ++s) {
    parts[s].level = static_cast<int>(s);
    parts[s].grid = coarser_grid(parts[s - 1].grid);
    parts[s].merged = intersect(interpolated_from(parts[s - 1].merged), parts[s].grid);
  }
  for (std::size_t s = 0; s < parts.size(); ++s) {
    RhfPart& p = parts[s];
    p.filtered = s + 1 == parts.size() ? p.merged : intersect(averaged_from(parts[s + 1].merged), p.grid);
    p.counted = intersect(grown(p.filtered, covering), p.grid);
    p.compared = intersect(grown(p.counted, radius), p.grid);
    p.outer = s == 0 ? tile.outer : intersect(grown(p.compared, patch), p.grid);
    assert(p.filtered.contains(p.merged));
    assert(tile.outer.contains(intersect(
        made_from(s == 0 ? intersect(grown(p.compared, patch), frame) : p.outer, {p.level}), frame)));
  }
  return parts;
}

}  // namespace tessera
