// SPDX-License-Identifier: Apache-2.0
// Blockwise Multi-Order Feature Regression of Koskela et al. 2019 (BMFR). Without history, several displaced
// grids of blocks take the place of the displacement from frame to frame.
#include <algorithm>

#include "core/filter/blocks.h"
#include "core/filter/descriptions.h"
#include "core/filter/taa.h"

namespace tessera {
namespace {

// The authors' program moves its blocks of 32 pixels by one of these from frame to frame.
struct Offset {
  int x, y;
};
constexpr Offset kOffsets[] = {{-14, -14}, {4, -6},   {-8, 14}, {8, 0},    {-10, -8}, {2, 12},
                               {12, -12},  {-10, 0},  {12, 14}, {-8, -16}, {6, 6},    {-2, -2},
                               {6, -14},   {-16, 12}, {14, -4}, {-6, 4}};

void append_features(std::vector<Parameter>& to) {
  constexpr std::string_view source = "Koskela et al. 2019, section 5";
  to.push_back(choice_parameter("normals", "columns of the fit: shading normals, or their squares too",
                                source, {"off", "on", "squared"}, 1));
  to.push_back(choice_parameter("positions", "columns of the fit: world positions, or their squares too",
                                source, {"off", "on", "squared"}, 2));
  to.push_back(choice_parameter("gradients", "columns of the fit: the place in the block, across and down",
                                source, {"off", "on"}));
  to.push_back(choice_parameter("material", "a column of the fit: the number of the material",
                                "Koskela et al. 2019, section 8, figure 12", {"off", "on"}));
}

void append_history(std::vector<Parameter>& to) {
  constexpr std::string_view source = "Koskela et al. 2019, section 3.2; the number is of its program";
  to.push_back(history_parameter());
  to.push_back({"alpha", "least share of a new frame in the light that is fitted", "1",
                "Koskela et al. 2019, section 3.2", 0.001, 1, 0.2});
  to.push_back({"alpha_filtered", "least share of a new frame in the light that was fitted", "1",
                "Koskela et al. 2019, section 3.5", 0.001, 1, 0.1});
  to.push_back(choice_parameter(
      "test",
      "what tells that a pixel before is of the same surface, beside its normal: the position, or else "
      "the depth and the object, for a surface that moved",
      "position: Koskela et al. 2019, section 3.2; moving: Schied et al. 2017, section 4.1",
      {"position", "moving"}, 1));
  to.push_back({"limit_p", "how far its point may be", "pixel footprints",
                "ours: Koskela et al. 2019 set a distance for each scene", 0.01, 1e4, 2});
  to.push_back({"distance_p", "how far its point may be, where not 0 and so in place of limit_p",
                "world units", "Koskela et al. 2019 take 0.03 to 0.1 in their program", 0, 1e9, 0});
  to.push_back({"limit_n", "how far its normal may be", "1", source, 1e-3, 3, 0.5});
}

constexpr int kGridsOfAFrame = 4;

std::vector<Parameter> parameters() {
  std::vector<Parameter> all{
      choice_parameter("block", "edge of the blocks that share a fit, in pixels",
                       "Koskela et al. 2019, section 6.1 (32; 64 looks best)", {"8", "16", "32", "64"}, 2),
      {"grids",
       "displaced grids of blocks whose fits are averaged, each by its distance from the block's border; 0: "
       "1 with a history, 4 without and on the first frame",
       "", "1: Koskela et al. 2019, section 3.3; more: its section 8 advises it where there is no history", 0,
       4, 0, true},
      {"frame",
       "which of 16 displacements of the grids is taken; 0: by the number of the frame",
       "",
       "Koskela et al. 2019, section 6.1; the numbers are its program's",
       0,
       15,
       0,
       true,
       {},
       SceneFact::frame},
      choice_parameter("regularisation",
                       "what keeps the fit stable: a ridge, which is what the paper's noise amounts to on "
                       "average, or that noise added to the features",
                       "stochastic: Koskela et al. 2019, section 3.4; ridge: its expectation",
                       {"ridge", "stochastic"}),
      {"epsilon", "largest noise on a feature, of its range in the block; the ridge is of the same strength",
       "1", "Koskela et al. 2019, section 3.4", 1e-3, 1, 0.01},
      {"clamp",
       "luminance is clamped to so many standard deviations above the mean of a quarter block; beyond half "
       "an edge nothing is",
       "standard deviations", "ours: one firefly would light its whole block", 1, 1000, 3},
  };
  append_features(all);
  append_history(all);
  append_taa_parameters(all);
  return all;
}

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::emission, Aov::albedo, Aov::normal, Aov::position, Aov::depth});
  if (with_history(values)) append(all, {Aov::motion});
  if (with_history(values) && surfaces_move(values)) append(all, {Aov::previous_depth, Aov::object_id});
  append_taa_inputs(all, values);
  if (block_features(values).material) append(all, {Aov::material_id});
  return all;
}

// Light, how many frames it is of, normal, position, and depth and object if they are compared; filtered
// light.
int own_history(const ParameterValues& values) {
  if (!with_history(values)) return 0;
  return 3 + 1 + 3 + 3 + (surfaces_move(values) ? 2 : 0) + 3;
}
int history(const ParameterValues& values) { return own_history(values) + taa_history(values); }

// Pixels of a cell.
double cell_area(const ParameterValues& values) {
  const double edge = 4 << static_cast<int>(values.find("block")->second);
  return edge * edge;
}

constexpr double kLight = 3 * 3 + 16 * 2;

Pass accumulation(const ParameterValues& values) {
  const double kept = own_history(values), read = 16 + 2 + (surfaces_move(values) ? 2 : 0);
  const double test = 2 * 3 * 3 + 4 + (surfaces_move(values) ? 5 : 0),
               tap = 4 + test + 7 + 3 + 2 * kAccumulatedPlanes;
  constexpr double kFootprint = 4 * 10 + 6, kPlace = 12, kMix = 8 + 3 * 6;
  return {"bmfr_accumulate", 1, 1, kLight + kFootprint + kPlace + 4 * tap + kMix,
          read + kept + kAccumulatedPlanes};
}

std::vector<Pass> passes(const ParameterValues& values) {
  const BlockSizes s = block_sizes(values);
  const double cell = cell_area(values);
  const int reach = (8 << static_cast<int>(values.find("block")->second)) - 1;
  constexpr double kClip = 2 * 3 * 10;
  const double f = s.features, mean = 6 + 9 * 2 + 3;
  const double noise = s.columns > 1 + f ? f * 13 : 0;
  const double change = 2 * 2 * f * (2 * s.columns + 3), solve = f * f * f / 3 + 2 * 3 * f * f;
  const double model = 2 * (3 + 3 * f) + f + 4;
  const bool temporal = with_history(values);
  std::vector<Pass> all;
  if (temporal) all.push_back(accumulation(values));
  all.push_back({"bmfr_cells", 1, reach,
                 (temporal ? 0 : kLight) + kClip + mean + s.roles * (noise + 2 * s.sums()),
                 temporal ? 10.0 : 16.0});
  all.push_back({"bmfr_fit", 1, 0, (4 * (change + 130) + 2 * 130 + solve) / cell,
                 (4 * s.sums() + 3 * s.axes + 6 + s.of_model()) / cell});
  all.push_back({"finish", 1, 0, kLight + grids_taken(values) * model + 10 + (temporal ? 3 * 3 + 2 : 0),
                 16 + 3 + (temporal ? kAccumulatedPlanes + own_history(values) : 0.0)});
  append_taa_pass(all, values);
  return all;
}

// Of cells and models there are more per pixel in a small tile: a cell at each border is partly outside.
double scratch(const ParameterValues& values) {
  const BlockSizes s = block_sizes(values);
  return 2.0 * (s.of_cell() + s.of_model()) / cell_area(values) +
         (with_history(values) ? kAccumulatedPlanes : 0) + taa_scratch(values);
}

// Where nothing has been averaged over frames one grid's blocks would show.
void alone(ParameterValues& values) {
  double& grids = values.find("grids")->second;
  if (grids == 0) grids = kGridsOfAFrame;
}

}  // namespace

BlockGrid block_grid(const FilterPlan& plan) {
  const int edge = 8 << static_cast<int>(plan["block"]);
  const Offset& o = kOffsets[static_cast<int>(plan["frame"])];
  return {edge, (o.x * edge >> 5) - edge / 2, (o.y * edge >> 5) - edge / 2};
}

int grids_taken(const ParameterValues& values) {
  const int asked = static_cast<int>(values.find("grids")->second);
  return asked != 0 ? asked : with_history(values) ? 1 : kGridsOfAFrame;
}

BlockFeatures block_features(const ParameterValues& values) {
  const auto number = [&](std::string_view name) { return static_cast<int>(values.find(name)->second); };
  return {number("normals"), number("positions"), number("gradients"), number("material")};
}

BlockSizes block_sizes(const ParameterValues& values) {
  const bool noisy = values.find("regularisation")->second == 1;
  const BlockFeatures f = block_features(values);
  return {f.columns(), f.axes(), 1 + (noisy ? 2 : 1) * f.columns(), noisy ? 4 : 1};
}

bool surfaces_move(const ParameterValues& values) { return values.find("test")->second == 1; }

FilterDescription describe_bmfr() {
  return {.name = "bmfr",
          .summary = "blocks of pixels fitted by normals, positions and their squares",
          .source =
              "M. Koskela et al.: Blockwise Multi-Order Feature Regression for Real-Time Path-Tracing "
              "Reconstruction, ACM TOG 38(5), 2019",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch,
          .history = history,
          .alone = alone};
}

}  // namespace tessera
