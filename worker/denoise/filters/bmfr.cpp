// SPDX-License-Identifier: Apache-2.0
// BMFR (Koskela et al. 2019): with history the accumulation of light; sums over cells, fits of the blocks
// made of them, synthesis.
#include <fmt/format.h>

#include "core/filter/blocks.h"
#include "core/filter/descriptions.h"
#include "kernels.h"
#include "worker/denoise/programs.h"
#include "worker/denoise/taa.h"

namespace tessera {
namespace {

int floor_of_quotient(int a, int b) { return a / b - (a % b < 0); }

bool stochastic(const FilterPlan& plan) { return plan.is("regularisation", "stochastic"); }

// The cells of the blocks in which pixels of the picture lie: its own and those around. They are within the
// halo, or beyond the frame's border.
struct Cells {
  int x, y;           // pixel at which the first one starts, relative to the outer region
  int across, down;   // how many
  int odd_x, odd_y;   // parities of the first one's place in the grid
  int stride, plane;  // floats from one row, one plane to the next
};

Cells cells_of(const Stage& s, const Region& r) {
  const BlockGrid grid = block_grid(s.plan());
  const int edge = grid.cell();
  const int x0 = floor_of_quotient(r.x0 - grid.x, edge) - 1,
            x1 = floor_of_quotient(r.x1 - 1 - grid.x, edge) + 2;
  const int y0 = floor_of_quotient(r.y0 - grid.y, edge) - 1,
            y1 = floor_of_quotient(r.y1 - 1 - grid.y, edge) + 2;
  const int stride = x1 - x0;
  return {.x = grid.x + x0 * edge - s.outer().x0,
          .y = grid.y + y0 * edge - s.outer().y0,
          .across = x1 - x0,
          .down = y1 - y0,
          .odd_x = x0 & 1,
          .odd_y = y0 & 1,
          .stride = stride,
          .plane = stride * (y1 - y0) + s.vector()};
}

cl_int4 relative(const Region& r, const Region& outer) {
  return {{r.x0 - outer.x0, r.y0 - outer.y0, r.x1 - outer.x0, r.y1 - outer.y0}};
}

// Light accumulated over the frames; of one frame alone there is nothing to accumulate.
cl::Buffer accumulated(Stage& s) {
  const FilterPlan& plan = s.plan();
  if (!with_history(plan.parameters)) return s.input();
  const Region &outer = s.outer(), &over = s.region(0);
  const Planes planes = s.scratch(static_cast<std::size_t>(outer.area()) * kAccumulatedPlanes);
  const cl_float4 limits{{static_cast<float>(plan["limit_p"]), static_cast<float>(plan["distance_p"]),
                          static_cast<float>(plan["limit_n"]), 0}};
  s.run("bmfr_accumulate", over, 1, s.input(), outer.width(), outer.height(), Past{},
        static_cast<float>(plan["alpha"]), limits, Exactly{over}, planes);
  return planes.buffer;
}

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const Picture result = picture(s);
  const Cells c = cells_of(s, result.region);
  const BlockSizes sizes = block_sizes(plan.parameters);
  const Region& outer = s.outer();
  const cl::Buffer light = accumulated(s);
  const Planes cells = s.scratch(static_cast<std::size_t>(c.plane) * sizes.of_cell()),
               models = s.scratch(static_cast<std::size_t>(c.plane) * sizes.of_model());
  const cl_int4 lattice{{c.x, c.y, c.across, c.down}};
  const Region over{0, 0, c.across, c.down};
  s.run("bmfr_cells", over, 1, s.input(), light, outer.width(), outer.height(), relative(s.frame(), outer),
        lattice, static_cast<float>(plan["clamp"]), static_cast<cl_int>(plan["frame"]), cells, c.stride,
        cl_long{c.plane});
  // Noise from -epsilon to epsilon has this variance. No pivot is smaller than the ridge but by rounding.
  const double epsilon = plan["epsilon"], strength = epsilon * epsilon / 3;
  s.run("bmfr_fit", over, 1, cells, c.stride, cl_long{c.plane}, c.across, c.down, static_cast<float>(epsilon),
        static_cast<float>(stochastic(plan) ? 0 : strength),
        static_cast<float>(stochastic(plan) ? strength / 64 : strength), models);
  s.run("finish", result.region, 1, s.input(), outer.width(), outer.height(), light, models, c.stride,
        cl_long{c.plane}, lattice, cl_int2{{c.odd_x, c.odd_y}}, static_cast<float>(plan["alpha_filtered"]),
        Exactly{result.region}, result.buffer, Exactly{s.inner()}, s.output());
  taa(s, result);
}

std::string options(const FilterPlan& plan) {
  const BlockFeatures f = block_features(plan.parameters);
  return fmt::format(
      "-DCELL={} -DGRIDS={} -DCOLUMNS={} -DNORMALS={} -DPOSITIONS={} -DGRADIENTS={} -DMATERIAL={}"
      " -DTEMPORAL={:d} -DOBJECTS={:d}",
      block_grid(plan).cell(), grids_taken(plan.parameters), block_sizes(plan.parameters).columns, f.normals,
      f.positions, f.gradients, f.material, with_history(plan.parameters), surfaces_move(plan.parameters));
}

}  // namespace

Program bmfr_program() {
  return {"bmfr",
          {kernels::history_cl, kernels::taa_cl, kernels::bmfr_cl, kernels::bmfr_accumulate_cl,
           kernels::bmfr_cells_cl, kernels::bmfr_fit_cl, kernels::bmfr_finish_cl},
          options,
          run};
}

}  // namespace tessera
