// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion (Delbracio et al. 2014): which pixels agree, block by block, and what they agree on.
#include "core/filter/rhf.h"

#include <fmt/format.h>

#include <limits>

#include "kernels.h"
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
      " -DBLOCK_FLOATS={}{}{}{}",
      block.radius, block.patch, RhfBlock::columns, RhfBlock::rows, RhfBlock::margin, RhfBlock::stride,
      block.history_floats(), block.floats(), plan.is("average", "patches") ? " -DPATCHES" : "",
      plan.is("bins", "shared") ? " -DSHARED" : "", gated(plan) ? " -DGATE" : "");
}

// Lardinoije, section 4.2: the scales of albedo, and of normals mapped to 0..1 (half a normal's own).
float albedo_scale(const FilterPlan& plan) { return static_cast<float>(1 / (0.03 * plan["gate"])); }
float normal_scale(const FilterPlan& plan) { return static_cast<float>(0.5 / (0.06 * plan["gate"])); }

int blocks_over(const Region& region, const RhfBlock& block) {
  const auto parts = [](int size, int part) { return (size + part - 1) / part; };
  return parts(region.width(), RhfBlock::columns - 2 * block.patch) * parts(region.height(), RhfBlock::rows);
}

void run(Stage& s) {
  const RhfBlock block = block_of(s.plan());
  const bool gate = gated(s.plan()), patches = s.plan().is("average", "patches");
  const Planes guides = s.planes(gate ? 7 : 1, std::numeric_limits<float>::infinity());
  const Planes pixels = s.planes(6), pairs = s.planes(block.radius + 1);
  const int blocks = blocks_over(s.region(0), block);
  const Planes memory = s.scratch(static_cast<std::size_t>(blocks) * block.floats());
  const int w = s.outer().width(), h = s.outer().height();
  s.run("prepare", s.outer(), 1, s.input(), w, h, guides, pixels, s.layout(),
        gate ? albedo_scale(s.plan()) : 0.0f, gate ? normal_scale(s.plan()) : 0.0f);
  s.run("rhf_compare", Region{0, 0, 1, blocks}, 1, s.input(), w, h, guides, pixels, s.layout(),
        Exactly{s.region(0)}, static_cast<float>(s.plan()["threshold"]), memory, pairs);
  const Planes shares = patches ? s.planes(1) : pixels;  // of pixels, nobody reads them
  if (patches) s.run("rhf_count", s.region(1), 1, pixels, pairs, shares, s.layout(), Exactly{s.region(1)});
  s.run("rhf_average", s.inner(), 1, s.input(), w, h, guides, pixels, pairs, shares, s.layout(),
        Exactly{s.inner()}, s.output());
}

}  // namespace

Program rhf_program() { return {"rhf", {kernels::rhf_cl, kernels::rhf_average_cl}, options, run}; }

}  // namespace tessera
