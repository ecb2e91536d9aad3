// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion (Delbracio et al. 2014): which pixels agree, block by block, and what they agree on.
// Of several scales, each is filtered, and the low frequencies of the finer ones are replaced by the
// coarser's.
#include "core/filter/rhf.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "kernels.h"
#include "worker/denoise/filters/rhf_scales.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

RhfBlock block_of(const FilterPlan& plan) {
  return {static_cast<int>(plan["radius"]), static_cast<int>(plan["patch"])};
}

bool gated(const FilterPlan& plan) { return plan["gate"] > 0; }

std::string options(const FilterPlan& plan) {
  const RhfBlock block = block_of(plan);
  return fmt::format(
      "-DRADIUS={} -DPATCH={} -DCOLUMNS={} -DROWS={} -DMARGIN={} -DSTRIDE={} -DHISTORY_FLOATS={}"
      " -DBLOCK_FLOATS={}{}{}{}{}",
      block.radius, block.patch, RhfBlock::columns, RhfBlock::rows, RhfBlock::margin, RhfBlock::stride,
      block.history_floats(), block.floats(), plan.is("average", "patches") ? " -DPATCHES" : "",
      plan.is("bins", "shared") ? " -DSHARED" : "", gated(plan) ? " -DGATE" : "",
      plan["scales"] > 1 ? " -DSCALES" : "");
}

// Lardinoije, section 4.2: the scales of albedo, and of normals mapped to 0..1 (half a normal's own).
float albedo_scale(const FilterPlan& plan) { return static_cast<float>(1 / (0.03 * plan["gate"])); }
float normal_scale(const FilterPlan& plan) { return static_cast<float>(0.5 / (0.06 * plan["gate"])); }

int blocks_over(const Region& region, const RhfBlock& block) {
  const auto parts = [](int size, int part) { return (size + part - 1) / part; };
  return parts(region.width(), RhfBlock::columns - 2 * block.patch) * parts(region.height(), RhfBlock::rows);
}

// A scale on the device.
struct Scale {
  RhfPart part;
  Layout layout;
  cl::Buffer input;  // the filter's channels over part.outer
  Planes guides, pixels;

  int width() const { return part.outer.width(); }
  int height() const { return part.outer.height(); }
  Within within(const Region& r) const { return {r, part.outer}; }
};

std::size_t floats_of_light(const Region& r) { return 3 * static_cast<std::size_t>(r.area()); }

Scale prepared(Stage& s, const RhfPart& part, const Layout& layout, const cl::Buffer& input) {
  const bool gate = gated(s.plan());
  Scale scale{part, layout, input, {}, {}};
  scale.guides = s.planes(part.outer, layout, gate ? 7 : 1, std::numeric_limits<float>::infinity());
  scale.pixels = s.planes(part.outer, layout, 6);
  s.run("prepare", part.outer, 1, input, scale.width(), scale.height(), scale.guides, scale.pixels, layout,
        gate ? albedo_scale(s.plan()) : 0.0f, gate ? normal_scale(s.plan()) : 0.0f);
  return scale;
}

Scale decimated(Stage& s, const Scale& finest, const RhfPart& part) {
  const RhfBlock block = block_of(s.plan());
  const int step = RhfScale{part.level}.step();
  const Region &frame = s.frame(), &outer = part.outer;
  const Planes input = s.scratch(static_cast<std::size_t>(outer.area()) * s.plan().inputs().size());
  // As many samples as the picture has.
  const double samples = static_cast<double>(frame.area()) / static_cast<double>(part.grid.area());
  s.run("rhf_decimate", outer, 1, finest.input, finest.width(), finest.height(), finest.pixels, finest.layout,
        cl_int{step}, cl_int{step * outer.x0 - s.outer().x0}, cl_int{step * outer.y0 - s.outer().y0},
        static_cast<float>(samples), outer.width(), outer.height(), input);
  return prepared(s, part, Layout(outer, std::max(block.radius, block.patch), s.vector()), input.buffer);
}

// Writes the three planes of part.filtered.
void filter_scale(Stage& s, const Scale& scale, const Planes& memory, const cl::Buffer& filtered) {
  const RhfBlock block = block_of(s.plan());
  const RhfPart& part = scale.part;
  const bool patches = s.plan().is("average", "patches");
  const Planes pairs = s.planes(part.outer, scale.layout, block.radius + 1);
  const int w = scale.width(), h = scale.height();
  s.run("rhf_compare", Region{0, 0, 1, blocks_over(part.compared, block)}, 1, scale.input, w, h, scale.guides,
        scale.pixels, scale.layout, scale.within(part.compared), static_cast<float>(s.plan()["threshold"]),
        memory, pairs);
  // Of pixels, nobody reads them.
  const Planes shares = patches ? s.planes(part.outer, scale.layout, 1) : scale.pixels;
  if (patches)
    s.run("rhf_count", part.counted, 1, scale.pixels, pairs, shares, scale.layout,
          scale.within(part.counted));
  s.run("rhf_average", part.filtered, 1, scale.input, w, h, scale.guides, scale.pixels, pairs, shares,
        scale.layout, scale.within(part.filtered), filtered);
}

// R_s = F_s + U(R_{s+1} - D(F_s)), F filtered light. Takes R_{s+1} and makes it the difference.
void merge(Stage& s, const Scale& fine, const Planes& filtered, const Scale& coarse, const Planes& result,
           const cl::Buffer& merged) {
  const RhfPart &f = fine.part, &c = coarse.part;
  // Where the coarse scale's first pixel lies in the fine one.
  const cl_int2 first{{2 * c.outer.x0 - f.outer.x0, 2 * c.outer.y0 - f.outer.y0}};
  s.run("rhf_differ", c.merged, 1, filtered, fine.within(f.filtered), fine.pixels, fine.layout, first,
        coarse.pixels, coarse.layout, coarse.within(c.merged), result);
  s.run("rhf_merge", f.merged, 1, filtered, fine.within(f.filtered), fine.pixels, fine.layout, first, result,
        coarse.within(c.merged), coarse.within(c.grid), fine.within(f.merged), merged);
}

Planes working_memory(Stage& s, const std::vector<RhfPart>& parts) {
  const RhfBlock block = block_of(s.plan());
  int blocks = 0;
  for (const RhfPart& part : parts) blocks = std::max(blocks, blocks_over(part.compared, block));
  return s.scratch(static_cast<std::size_t>(blocks) * block.floats());
}

void run(Stage& s) {
  const std::vector<RhfPart> parts = rhf_parts(s.plan(), {s.inner(), s.outer()}, s.frame());
  const Scale finest = prepared(s, parts[0], s.layout(), s.input());
  const Planes memory = working_memory(s, parts);
  if (parts.size() == 1) return filter_scale(s, finest, memory, s.output());
  std::vector<Scale> scales{finest};
  std::vector<Planes> filtered;
  for (std::size_t k = 1; k < parts.size(); ++k) scales.push_back(decimated(s, finest, parts[k]));
  for (const Scale& scale : scales) {
    filtered.push_back(s.scratch(floats_of_light(scale.part.filtered)));
    filter_scale(s, scale, memory, filtered.back().buffer);
  }
  Planes result = filtered.back();  // the coarsest's filtered part is what is merged of it
  for (std::size_t k = scales.size() - 1; k-- > 0;) {
    const Planes merged = k == 0 ? Planes{s.output()} : s.scratch(floats_of_light(scales[k].part.merged));
    merge(s, scales[k], filtered[k], scales[k + 1], result, merged.buffer);
    result = merged;
  }
}

}  // namespace

Program rhf_program() {
  return {"rhf", {kernels::rhf_cl, kernels::rhf_average_cl, kernels::rhf_scales_cl}, options, run};
}

}  // namespace tessera
