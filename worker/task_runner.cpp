// SPDX-License-Identifier: Apache-2.0
#include "worker/task_runner.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <chrono>
#include <set>

#include "core/error.h"
#include "core/plan.h"
#include "proto/clock.h"
#include "worker/denoise/runner.h"
#include "worker/latest_cache.h"
#include "worker/render/render.h"
#include "worker/render/texture_cache.h"

namespace tessera {
namespace {

class StandardRunner : public TaskRunner {
 public:
  StandardRunner(SceneSource source, DevicePool devices, std::size_t scenes_kept,
                 const TextureOptions& textures)
      : source_(std::move(source)),
        devices_(std::move(devices)),
        textures_(std::make_shared<tracer::TextureCache>(textures)),
        cores_(tracer::kept_cores(scenes_kept)),
        scenes_(scenes_kept),
        ready_(scenes_kept) {}

  TaskResult run(const Job& job, const Task& task, const FilterInput& input,
                 const std::atomic<bool>& cancel) override {
    if (const auto* work = std::get_if<RenderTask>(&task.work)) return run(job, *work, cancel);
    return run(job, std::get<FilterTask>(task.work), input);
  }

 private:
  TaskResult run(const Job& job, const RenderTask& work, const std::atomic<bool>& cancel) {
    const auto loaded = scenes_.find_or_make(job.scene.hash, [&] { return source_(job.scene); });
    const auto scene =
        ready_.find_or_make(job.scene.hash + ' ' + preparation(*loaded, job.render, job.frame),
                            [&] { return prepare(loaded, job.render, job.frame, textures_, cores_); });
    RenderSettings settings = job.render;
    settings.aovs = film_aovs(job);
    RenderDone done{.block = render(*scene, settings, job.frame, work.region, work.samples, &cancel)};
    require_sound_textures(*scene);
    done.dropped = dropped(done.block);
    return done;
  }

  TaskResult run(const Job& job, const FilterTask& work, const FilterInput& input) {
    if (const int taken = filter_shape(job).taken; input.film.planes() != taken)
      throw Error(ExitCode::internal_error,
                  fmt::format("filter task: the film has {} planes, not {}", input.film.planes(), taken));
    DevicePool::Use use = devices_.use(static_cast<double>(work.tile.outer.area()));
    const Instant begin = clock_now();
    FilterDone done;
    if (job.given)
      done.filtered = filter(use.device(), job.filter, input.film, work.tile, job.region(), input.history);
    else
      done.filtered = filter_task(use.device(), job.filter, input.film, FilmLayout(filter_aovs(job)),
                                  work.tile, job.region(), input.history);
    use.done(seconds_between(begin, clock_now()));
    return done;
  }

  SceneSource source_;
  DevicePool devices_;                              // shared by the slots
  std::shared_ptr<tracer::TextureCache> textures_;  // shared with the scenes
  tracer::CoreSource cores_;                        // shared by scenes of the same shapes
  LatestCache<Scene> scenes_;                       // by content hash
  LatestCache<RenderScene> ready_;                  // by content hash and preparation
};

// What this binary was compiled for, and what Embree and OpenCL compile for.
std::string instruction_sets() {
#if defined(__AVX512F__)
  const std::string_view built = "avx512";
#elif defined(__AVX2__)
  const std::string_view built = "avx2";
#else
  const std::string_view built = "base";
#endif
  const bool avx512 = __builtin_cpu_supports("avx512f"), avx2 = __builtin_cpu_supports("avx2");
  return fmt::format("{} on {}", built, avx512 ? "avx512" : avx2 ? "avx2" : "base");
}

}  // namespace

SceneSource scene_in_hand(std::shared_ptr<const Scene> scene) {
  return [scene = std::move(scene)](const SceneRef&) { return scene; };
}

std::unique_ptr<TaskRunner> make_task_runner(SceneSource source, DevicePool devices, std::size_t scenes_kept,
                                             const TextureOptions& textures) {
  return std::make_unique<StandardRunner>(std::move(source), std::move(devices), scenes_kept, textures);
}

std::string device_class(const std::string& version, const std::vector<DeviceInfo>& devices) {
  std::set<std::string> kinds;
  for (const DeviceInfo& d : devices) kinds.insert(fmt::format("{} {} {}", d.name, d.version, d.driver));
  return fmt::format("tessera {} {} {}", version, instruction_sets(), fmt::join(kinds, " + ")).substr(0, 256);
}

}  // namespace tessera
