// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/runner.h"

#include <fmt/format.h>

#include <algorithm>
#include <new>

#include "core/error.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

void check(const FilterPlan& plan, const Image& input, const Tile& tile, const Region& frame,
           const Image& history) {
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
  if (!history.empty() && (history.planes() != plan.history() || !frame.contains(history.region())))
    throw Error(ExitCode::bad_input,
                fmt::format("filter '{}' keeps a history of {} planes of the frame; got {}", plan.name,
                            plan.history(), history.planes()));
}

}  // namespace

Image filter(Device& device, const FilterPlan& plan, const Image& input, const Tile& tile,
             const Region& frame, const Image& history) {
  check(plan, input, tile, frame, history);
  if (plan.passes().empty()) return cropped(input, tile.inner);
  ClDevice& cl = dynamic_cast<ClDevice&>(device);
  const std::lock_guard lock(cl.mutex());
  try {
    const Program& program = program_of(plan.name);
    const FilterPlan now = history.empty() ? without_history(plan) : plan;
    Stage stage(cl, now, program.sources, program.options(now), input, tile, frame, history);
    program.run(stage);
    return stage.finish();
  } catch (const cl::Error& e) {
    rethrow(e, cl.info());
  } catch (const std::bad_alloc&) {
    throw Error(ExitCode::out_of_memory,
                fmt::format("filter '{}': not enough memory; smaller tiles need less", plan.name));
  }
}

void recycle(Device& device, Image result) {
  ClDevice& cl = dynamic_cast<ClDevice&>(device);
  const std::lock_guard lock(cl.mutex());
  cl.give_back(std::move(result));
}

Filtered filter_task(Device& device, const FilterPlan& plan, const Image& sums, const FilmLayout& layout,
                     const Tile& tile, const Region& frame, const Image& history) {
  Filtered result(tile.inner, filtered_planes(plan));
  const int kept = plan.history();
  if (!history.empty() && history.planes() != history_planes(plan))
    throw Error(ExitCode::bad_input, fmt::format("filter task: the history has {} planes, not {}",
                                                 history.planes(), history_planes(plan)));
  for (const Part part : {Part::all, Part::a, Part::b}) {
    const int number = part == Part::all ? 0 : part == Part::a ? 1 : 2;
    const Image input = developed(sums, layout, plan.inputs(), part);
    const Image before = history.empty() ? Image{} : planes_of(history, number * kept, kept);
    Image output = filter(device, plan, input, tile, frame, before);
    for (int p = 0; p < 3; ++p) std::ranges::copy(output.plane(p), result.plane(3 * number + p).begin());
    for (int p = 0; p < kept; ++p)
      std::ranges::copy(output.plane(3 + p), result.plane(kFilteredPlanes + number * kept + p).begin());
    recycle(device, std::move(output));
  }
  return result;
}

}  // namespace tessera
