// SPDX-License-Identifier: Apache-2.0
// Blockwise Multi-Order Feature Regression of Koskela et al. 2019 (BMFR) of a single frame: no history, so
// several displaced grids of blocks take the place of the displacement from frame to frame.
#include "core/filter/blocks.h"
#include "core/filter/descriptions.h"

namespace tessera {
namespace {

// The authors' program moves its blocks of 32 pixels by one of these from frame to frame.
struct Offset {
  int x, y;
};
constexpr Offset kOffsets[] = {{-14, -14}, {4, -6},   {-8, 14}, {8, 0},    {-10, -8}, {2, 12},
                               {12, -12},  {-10, 0},  {12, 14}, {-8, -16}, {6, 6},    {-2, -2},
                               {6, -14},   {-16, 12}, {14, -4}, {-6, 4}};

std::vector<Parameter> parameters() {
  return {
      {"block",
       "edge of the blocks that share a fit",
       "pixels",
       "Koskela et al. 2019, section 6.1 (32; 64 looks best)",
       0,
       3,
       2,
       true,
       {"8", "16", "32", "64"}},
      {"grids",
       "displaced grids of blocks whose fits are averaged, each by its distance from the block's border", "",
       "1: Koskela et al. 2019, section 3.3; more: its section 8 advises it where there is no history", 1, 4,
       4, true},
      {"frame", "which of 16 displacements of the grids is taken", "",
       "Koskela et al. 2019, section 6.1; the numbers are its program's", 0, 15, 0, true},
      {"regularisation",
       "what keeps the fit stable: a ridge, which is what the paper's noise amounts to on average, or that "
       "noise added to the features",
       "",
       "stochastic: Koskela et al. 2019, section 3.4; ridge: its expectation",
       0,
       1,
       0,
       true,
       {"ridge", "stochastic"}},
      {"epsilon", "largest noise on a feature, of its range in the block; the ridge is of the same strength",
       "1", "Koskela et al. 2019, section 3.4", 1e-3, 1, 0.01},
      {"clamp",
       "luminance is clamped to so many standard deviations above the mean of a quarter block; beyond half "
       "an edge nothing is",
       "standard deviations", "ours: one firefly would light its whole block", 1, 1000, 3},
  };
}

std::vector<Channel> inputs(const ParameterValues&) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::emission, Aov::albedo, Aov::normal, Aov::position, Aov::depth});
  return all;
}

struct Sizes {
  double cell;     // pixels of a cell
  double columns;  // of the fit: 1, normal, position, its squares; noise on all but the first
  double roles;    // in which a cell is summed up
};
Sizes sizes(const ParameterValues& values) {
  const double edge = 4 << static_cast<int>(values.find("block")->second);
  const bool noisy = values.find("regularisation")->second == 1;
  return {edge * edge, noisy ? 19.0 : 10.0, noisy ? 4.0 : 1.0};
}
double sums(const Sizes& s) { return s.columns * (s.columns + 1) / 2 + 3 * s.columns; }

std::vector<Pass> passes(const ParameterValues& values) {
  const Sizes s = sizes(values);
  const int reach = (8 << static_cast<int>(values.find("block")->second)) - 1;
  constexpr double kLight = 3 * 3 + 16 * 2, kClip = 2 * 3 * 10, kCentre = 6 + 9 * 2 + 3;
  const double noise = s.columns > 10 ? 9 * 13 : 0;
  const double change = 2 * 18 * (2 * s.columns + 3), solve = 9 * 9 * 9 / 3 + 2 * 3 * 81;
  constexpr double kModel = 2 * (3 + 27) + 9 + 4;
  return {
      {"bmfr_cells", 1, reach, kLight + kClip + kCentre + s.roles * (noise + 2 * sums(s)), 16},
      {"bmfr_fit", 1, 0, (4 * (change + 130) + 2 * 130 + solve) / s.cell, (4 * sums(s) + 15 + 42) / s.cell},
      {"finish", 1, 0, kLight + values.find("grids")->second * kModel + 10, 16 + 3}};
}

// Of cells and models there are more per pixel in a small tile: a cell at each border is partly outside.
double scratch(const ParameterValues& values) {
  const Sizes s = sizes(values);
  return 2 * (s.roles * sums(s) + 15 + 42) / s.cell;
}

}  // namespace

BlockGrid block_grid(const FilterPlan& plan) {
  const int edge = 8 << static_cast<int>(plan["block"]);
  const Offset& o = kOffsets[static_cast<int>(plan["frame"])];
  return {edge, (o.x * edge >> 5) - edge / 2, (o.y * edge >> 5) - edge / 2};
}

FilterDescription describe_bmfr() {
  return {.name = "bmfr",
          .summary = "blocks of pixels fitted by normals, positions and their squares",
          .source =
              "M. Koskela et al.: Blockwise Multi-Order Feature Regression for Real-Time Path-Tracing "
              "Reconstruction, ACM TOG 38(5), 2019",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch};
}

}  // namespace tessera
