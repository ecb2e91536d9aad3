// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/runner.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

void check(const FilterPlan& plan, const Image& input, const Tile& tile, const Region& frame) {
  const Region needed = intersect(grown(tile.inner, plan.halo()), frame);
  constexpr std::int64_t kMost = std::int64_t{1} << 30;  // pixels of a plane: indices in kernels are ints
  if (tile.inner.empty() || !frame.contains(tile.inner) || tile.outer != needed || tile.outer.area() > kMost)
    throw Error(ExitCode::bad_input,
                fmt::format("filter task: the tile's outer region is not its inner region"
                            " grown by {} and cut to the frame",
                            plan.halo()));
  if (input.region() != tile.outer || input.planes() != static_cast<int>(plan.inputs().size()))
    throw Error(ExitCode::bad_input,
                fmt::format("filter '{}' takes {} planes over the tile's outer region; got {}", plan.name,
                            plan.inputs().size(), input.planes()));
}

}  // namespace

Image filter(Device& device, const FilterPlan& plan, const Image& input, const Tile& tile,
             const Region& frame) {
  check(plan, input, tile, frame);
  if (plan.passes().empty()) return cropped(input, tile.inner);
  ClDevice& cl = dynamic_cast<ClDevice&>(device);
  const std::lock_guard lock(cl.mutex());
  try {
    const Program& program = program_of(plan.name);
    Stage stage(cl, plan, program.sources, program.options(plan), input, tile, frame);
    program.run(stage);
    return stage.finish();
  } catch (const cl::Error& e) {
    rethrow(e, cl.info());
  }
}

Filtered filter_task(Device& device, const FilterPlan& plan, const Image& sums, const FilmLayout& layout,
                     const Tile& tile, const Region& frame) {
  Filtered result(tile.inner, kFilteredPlanes);
  auto to = result.data().begin();
  for (const Part part : {Part::all, Part::a, Part::b}) {
    const Image input = developed(sums, layout, plan.inputs(), part);
    const Image output = filter(device, plan, input, tile, frame);
    to = std::ranges::copy(output.data(), to).out;
  }
  return result;
}

}  // namespace tessera
