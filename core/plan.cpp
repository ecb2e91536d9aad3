// SPDX-License-Identifier: Apache-2.0
#include "core/plan.h"

#include <algorithm>
#include <cassert>

namespace tessera {
namespace {

constexpr std::int64_t kManyTasks = 256;
constexpr int kGrowth = 4;

// Pixel samples of a task. A block is as large for 8 samples as for 4096, so what a round of many costs to
// send, keep and add up falls with the size of its tasks. With kManyTasks of them the last ones are a small
// part of a round, but where a single frame has more slots than that: there they cost a task's time at most,
// some seconds.
std::int64_t task_samples(const Job& job, const std::vector<Region>& cells, const std::vector<int>& have,
                          const std::vector<int>& want) {
  std::int64_t round = 0;
  for (std::size_t i = 0; i < cells.size(); ++i) round += cells[i].area() * (want[i] - have[i]);
  const std::int64_t least = job.task_samples;
  return std::clamp(round / kManyTasks, least, kGrowth * least);
}

}  // namespace

AovSet film_aovs(const Job& job) { return job.render.aovs | AovSet{Aov::color} | filter_aovs(job); }

AovSet filter_aovs(const Job& job) { return aovs_of(job.filter.inputs()); }

FilterShape filter_shape(const Job& job) {
  if (job.given) {
    const int kept = job.filter.history();
    return {static_cast<int>(job.filter.inputs().size()), 3 + kept, kept};
  }
  return {FilmLayout(filter_aovs(job)).planes(), filtered_planes(job.filter), history_planes(job.filter)};
}

std::vector<Tile> plan_tiles(const Job& job) { return tiles_over(job.region(), job.tile, job.filter.halo()); }

std::vector<Region> plan_cells(const Job& job) { return grid_cells(job.region(), {kCellEdge, kCellEdge}); }

std::vector<RenderTask> plan_render(const Job& job, const std::vector<int>& have,
                                    const std::vector<int>& want) {
  const std::vector<Region> cells = plan_cells(job);
  assert(have.size() == cells.size() && want.size() == cells.size());
  const std::int64_t size = task_samples(job, cells, have, want);
  std::vector<RenderTask> tasks;
  for (std::size_t i = 0; i < cells.size(); ++i) {
    for (const Region& piece : grid_cells(cells[i], job.tile)) {
      const int most =
          static_cast<int>(std::clamp<std::int64_t>(size / piece.area(), kLeafSamples, kMaxSamples));
      // One doubling at a time, so that every block is a node of the film's tree.
      for (int n = have[i]; n < want[i];) {
        const int next = n == 0 ? want[i] : 2 * n;
        for (const SampleRange& samples : dyadic_blocks({n, next}, most)) tasks.push_back({piece, samples});
        n = next;
      }
    }
  }
  return tasks;
}

}  // namespace tessera
