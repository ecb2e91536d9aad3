// SPDX-License-Identifier: Apache-2.0
// BMFR (Koskela et al. 2019) of a single frame: sums over cells, fits of the blocks made of them, synthesis.
#include <fmt/format.h>

#include "core/filter/blocks.h"
#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr int kCellPlanes = 15;  // beside the sums
constexpr int kModelPlanes = 42;

int floor_of_quotient(int a, int b) { return a / b - (a % b < 0); }

bool stochastic(const FilterPlan& plan) { return plan.is("regularisation", "stochastic"); }
int columns(const FilterPlan& plan) { return stochastic(plan) ? 19 : 10; }
int planes_of_cell(const FilterPlan& plan) {
  const int n = columns(plan), sums = n * (n + 1) / 2 + 3 * n;
  return (stochastic(plan) ? 4 : 1) * sums + kCellPlanes;
}

// The cells of the blocks in which pixels of the inner region lie: its own and those around. They are within
// the halo, or beyond the frame's border.
struct Cells {
  int x, y;           // pixel at which the first one starts, relative to the outer region
  int across, down;   // how many
  int odd_x, odd_y;   // parities of the first one's place in the grid
  int stride, plane;  // floats from one row, one plane to the next
};

Cells cells_of(const Stage& s) {
  const BlockGrid grid = block_grid(s.plan());
  const int edge = grid.cell();
  const Region& r = s.inner();
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

void run(Stage& s) {
  const FilterPlan& plan = s.plan();
  const Cells c = cells_of(s);
  const Planes cells = s.scratch(static_cast<std::size_t>(c.plane) * planes_of_cell(plan)),
               models = s.scratch(static_cast<std::size_t>(c.plane) * kModelPlanes);
  const Region& outer = s.outer();
  const cl_int4 lattice{{c.x, c.y, c.across, c.down}};
  const cl_int4 frame{
      {s.frame().x0 - outer.x0, s.frame().y0 - outer.y0, s.frame().x1 - outer.x0, s.frame().y1 - outer.y0}};
  const Region over{0, 0, c.across, c.down};
  s.run("bmfr_cells", over, 1, s.input(), outer.width(), outer.height(), frame, lattice,
        static_cast<float>(plan["clamp"]), static_cast<cl_int>(plan["frame"]), cells, c.stride,
        cl_long{c.plane});
  // Noise from -epsilon to epsilon has this variance. No pivot is smaller than the ridge but by rounding.
  const double epsilon = plan["epsilon"], strength = epsilon * epsilon / 3;
  s.run("bmfr_fit", over, 1, cells, c.stride, cl_long{c.plane}, c.across, c.down, static_cast<float>(epsilon),
        static_cast<float>(stochastic(plan) ? 0 : strength),
        static_cast<float>(stochastic(plan) ? strength / 64 : strength), models);
  s.run("finish", s.inner(), 1, s.input(), outer.width(), outer.height(), models, c.stride, cl_long{c.plane},
        lattice, cl_int2{{c.odd_x, c.odd_y}}, Exactly{s.inner()}, s.output());
}

std::string options(const FilterPlan& plan) {
  return fmt::format("-DCELL={} -DGRIDS={} -DCOLUMNS={}", block_grid(plan).cell(), plan["grids"],
                     columns(plan));
}

}  // namespace

Program bmfr_program() {
  return {"bmfr", {kernels::bmfr_cl, kernels::bmfr_cells_cl, kernels::bmfr_fit_cl}, options, run};
}

}  // namespace tessera
