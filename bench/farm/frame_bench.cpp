// SPDX-License-Identifier: Apache-2.0
// What the farm costs: a frame through coordinator, messages, leases, folding and tiles, against the same
// samples rendered by the same number of threads with plain calls, and the whole frame filtered at once.
// usage: frame_bench [scene file] [samples]
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <string>
#include <thread>

#include "cli/local_farm.h"
#include "core/error.h"
#include "core/plan.h"
#include "core/scene/load.h"
#include "worker/denoise/runner.h"
#include "worker/render/render.h"

namespace tessera {
namespace {

using Seconds = std::chrono::duration<double>;

template <class Work>
double seconds(const Work& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return Seconds(std::chrono::steady_clock::now() - begin).count();
}

// Threads take 64x64 cells from a shared counter; no copies but the film's own.
Filtered plainly(const RenderScene& scene, Device& device, const Job& job, int threads) {
  RenderSettings settings = job.render;
  settings.aovs = film_aovs(job);
  const FilmLayout layout(settings.aovs);
  Image film(job.region(), layout.planes());
  const std::vector<Region> cells = plan_cells(job);
  std::atomic<std::size_t> next = 0;
  {
    std::vector<std::jthread> hands;
    for (int t = 0; t < threads; ++t)
      hands.emplace_back([&] {
        for (std::size_t c = next++; c < cells.size(); c = next++)
          paste(film, render(scene, settings, job.frame, cells[c], {0, job.acceptance.max_samples}).sums);
      });
  }
  return filter_task(device, job.filter, film, layout, {job.region(), job.region()}, job.region());
}

int run(const std::string& file, int samples) {
  const auto scene = std::make_shared<const Scene>(load_scene(file));
  const auto ready = prepare(scene);
  const auto device = Device::open("");
  Job job;
  job.scene.hash = content_hash(*scene);
  job.filter = parse_filter("svgf");
  job.acceptance.max_samples = samples;
  const int threads = usable_threads();
  LocalFarm farm(scene, threads, "");
  plainly(*ready, *device, job, threads);  // builds kernels, warms caches
  farm.coordinator().run(job);

  std::vector<double> plain, farmed, ratio;
  bool same = true;
  for (int i = 0; i < 5; ++i) {
    Filtered whole;
    JobReport report;
    plain.push_back(seconds([&] { whole = plainly(*ready, *device, job, threads); }));
    farmed.push_back(seconds([&] { report = farm.coordinator().run(job); }));
    ratio.push_back(farmed.back() / plain.back());
    same = same && std::equal(report.image.filtered.data().begin(), report.image.filtered.data().end(),
                              whole.data().begin());
  }
  const auto median = [](std::vector<double> v) {
    std::sort(v.begin(), v.end());
    return v[v.size() / 2];
  };
  fmt::print("{} {}x{}, {} samples, svgf, {} threads, 5 pairs, medians\n", file, job.render.size.width,
             job.render.size.height, samples, threads);
  fmt::print("plain calls, whole frame  {:8.3f} s\nfarm, tiles of {}x{}     {:8.3f} s\n", median(plain),
             job.tile.width, job.tile.height, median(farmed));
  fmt::print(
      "farm / plain              {:8.3f}   (least {:.3f}, most {:.3f}); goal: at most 1.05\nsame bits: {}\n",
      median(ratio), *std::min_element(ratio.begin(), ratio.end()),
      *std::max_element(ratio.begin(), ratio.end()), same ? "yes" : "NO");
  return same ? 0 : 1;
}

}  // namespace
}  // namespace tessera

int main(int argc, char** argv) {
  try {
    return tessera::run(argc > 1 ? argv[1] : TESSERA_SOURCE_DIR "/scenes/cornell.json",
                        argc > 2 ? std::stoi(argv[2]) : 64);
  } catch (const tessera::Error& e) {
    fmt::print(stderr, "frame_bench: {}\n", e.what());
    return static_cast<int>(e.code());
  }
}
