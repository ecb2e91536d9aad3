// SPDX-License-Identifier: Apache-2.0
// tessera render: a local farm, one frame, files.
#include <fmt/format.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <mutex>

#include "cli/local_farm.h"
#include "cli/render_options.h"
#include "cli/signals.h"
#include "cli/subcommand.h"
#include "cli/version.h"
#include "coordinator/output.h"
#include "core/error.h"
#include "core/png.h"
#include "core/scene/facts.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

void set_up_log(const RenderOptions& o) {
  auto log = std::make_shared<spdlog::logger>("tessera", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_level(spdlog::level::from_str(o.verbose && o.log_level == "warning" ? "info" : o.log_level));
  log->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  spdlog::set_default_logger(std::move(log));
}

ProgressStyle progress_style(const RenderOptions& o) {
  if (o.quiet || o.progress == "none") return ProgressStyle::none;
  if (o.progress == "bar") return ProgressStyle::bar;
  if (o.progress == "lines") return ProgressStyle::lines;
  if (o.progress == "json") return ProgressStyle::json;
  if (o.progress == "openjd") return ProgressStyle::openjd;
  return usual_progress_style(isatty(STDERR_FILENO) != 0, std::getenv("OPENJD_SESSION_WORKING_DIR"));
}

fs::path output_file(const RenderOptions& o) {
  const fs::path file =
      o.output.empty() ? fs::path(o.scene).filename().replace_extension(".exr") : fs::path(o.output);
  if (file.extension() != ".exr")
    throw Error(
        ExitCode::bad_usage,
        fmt::format("--output: '{}' is not accepted; accepted: a name ending in .exr", file.string()));
  const fs::path folder = file.has_parent_path() ? file.parent_path() : ".";
  if (!fs::is_directory(folder))
    throw Error(ExitCode::bad_usage, fmt::format("--output: there is no folder '{}'", folder.string()));
  if (access(folder.c_str(), W_OK) != 0)
    throw Error(ExitCode::bad_usage, fmt::format("--output: cannot write into '{}'", folder.string()));
  return file;
}

// A frame that cannot fit is refused before anything is rendered.
void require_memory(const Job& job) {
  const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)),
               page = static_cast<double>(sysconf(_SC_PAGESIZE));
  const double needed = Frame::bytes(job), there = pages * page;
  if (needed > there)
    throw Error(
        ExitCode::out_of_memory,
        fmt::format("the frame needs {:.1f} GiB, this machine has {:.1f}; try --crop or a smaller size",
                    needed / (1u << 30), there / (1u << 30)));
}

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& t : things) names.push_back(t.name);
  return names;
}

// The picture with its coverage, where the scene stands before nothing.
Image preview(const Scene& scene, const ExrImage& exr) {
  std::vector<float> data;
  for (const char* channel : {"R", "G", "B", "A"}) {
    if (*channel == 'A' && scene.background.kind != Background::Kind::transparent) continue;
    const auto plane = exr.pixels.plane(exr.plane(channel));
    data.insert(data.end(), plane.begin(), plane.end());
  }
  const int planes = static_cast<int>(data.size() / exr.pixels.plane(0).size());
  return {exr.pixels.region(), planes, std::move(data)};
}

void write(const RenderOptions& o, const fs::path& file, const Job& job, const Scene& scene,
           const JobReport& report) {
  Provenance from{.version = std::string(kVersion),
                  .device = fmt::format("{}", fmt::join(report.device_classes, "; ")),
                  .scene_hash = job.scene.hash,
                  .seconds = report.seconds,
                  .light_groups = scene.light_groups,
                  .objects = names_of(scene.objects),
                  .materials = names_of(scene.materials),
                  .dropped = report.dropped};
  if (!o.layers_for.empty()) from.filter_inputs = parse_filter(o.layers_for).inputs();
  const ExrImage image = layered(job, report.image, from);
  write_exr(file, image, o.compression);
  write_png(fs::path(file).replace_extension(".png"), preview(scene, image), static_cast<float>(o.exposure));
}

int exit_code(const Job& job, const JobReport& report) {
  const StopReason why = report.image.stop.value_or(StopReason::interrupted);
  if (why == StopReason::interrupted) return static_cast<int>(ExitCode::interrupted);
  // Without a target there is nothing to fall short of.
  const bool done = why == StopReason::accepted || !job.acceptance.relmse;
  return static_cast<int>(done ? ExitCode::done : ExitCode::stopped_at_limit);
}

void summarise(const Job& job, const JobReport& report, const fs::path& file) {
  const double samples = static_cast<double>(report.image.pixel_samples);
  fmt::print("{}\n{:.1f} M pixel samples ({:.1f} per pixel) in {} rounds, {:.1f} s\n{}\n",
             verdict(job, report.image), samples * 1e-6, samples / static_cast<double>(job.region().area()),
             report.image.rounds, report.seconds, file.string());
  if (report.dropped > 0) fmt::print("{} samples were not finite and were dropped\n", report.dropped);
}

// What signals act on: nothing that is worth writing yet, a frame under way, or files being written.
class UnderWay {
 public:
  // While it lives, signals reach `coordinator`.
  class Watch {
   public:
    Watch(UnderWay& under_way, Coordinator& coordinator) : under_way_(under_way) {
      const std::lock_guard lock(under_way_.mutex_);
      under_way_.coordinator_ = &coordinator;
      under_way_.begun_ = true;
    }
    ~Watch() {
      const std::lock_guard lock(under_way_.mutex_);
      under_way_.coordinator_ = nullptr;
    }
    Watch(const Watch&) = delete;

   private:
    UnderWay& under_way_;
  };

  void hear(int signal) {
    const std::lock_guard lock(mutex_);
    if (!begun_ && signal != SIGUSR1) _exit(static_cast<int>(ExitCode::interrupted));
    if (coordinator_ == nullptr) return;
    signal == SIGUSR1 ? coordinator_->request_snapshot() : coordinator_->interrupt();
  }

 private:
  std::mutex mutex_;
  Coordinator* coordinator_ = nullptr;  // borrowed while there is a Watch
  bool begun_ = false;
};

// What the scene was made from is not to be written over.
void require_foreign(const fs::path& file, const RenderOptions& o, const Scene& scene) {
  std::vector<fs::path> sources{o.scene};
  for (const Picture& picture : scene.pictures) {
    sources.emplace_back(picture.name);
    for (const Picture& tile : picture.tiles) sources.emplace_back(tile.name);
  }
  for (const char* extension : {".exr", ".png"})
    for (const fs::path& source : sources) {
      const fs::path target = fs::path(file).replace_extension(extension);
      std::error_code none;
      if (fs::equivalent(target, source, none))
        throw Error(ExitCode::bad_usage,
                    fmt::format("--output: '{}' is a file of the scene itself", target.string()));
    }
}

// The frame, by a farm in this process.
JobReport run(const RenderOptions& o, const Job& job, const Scene& scene, LocalFarm& farm,
              UnderWay& under_way) {
  const ProgressStyle style = progress_style(o);
  ProgressDisplay display(style, style == ProgressStyle::bar ? stderr : stdout);
  const JobWatcher watcher{.progress = [&](const Progress& p) { display.show(p); },
                           .interval = Millis{50},
                           .snapshot =
                               [&](const JobReport& now) {
                                 try {
                                   write(o, output_file(o), job, scene, now);
                                 } catch (const Error& e) {
                                   spdlog::error("no snapshot: {}", e.what());  // the frame goes on
                                 }
                               }};
  const UnderWay::Watch watch(under_way, farm.coordinator());
  return farm.coordinator().run(job, watcher);
}

int render_scene(const RenderOptions& o) {
  set_up_log(o);
  if (o.scene.empty())
    throw Error(ExitCode::bad_usage,
                "render: which scene? accepted: a .json, .gltf, .glb, .obj, .fbx or .ply file");
  Job job = job_of(o);
  const fs::path file = output_file(o);
  require_memory(job);

  UnderWay under_way;
  const Signals signals([&](int signal) { under_way.hear(signal); });
  const auto scene = std::make_shared<const Scene>(load_scene(o.scene, o.limits));
  for (const std::string& warning : scene->warnings) spdlog::warn("{}", warning);
  camera_index(*scene, o.camera);
  variant_of(*scene, o.variant);
  job.render.aovs = job.render.aovs | groups_of(o, scene->light_groups.size());
  require_foreign(file, o, *scene);
  job.filter = resolved(std::move(job.filter), facts_of(*scene));
  job.scene.hash = content_hash(*scene);

  LocalFarm farm(scene, o.threads.value_or(usable_threads()), o.device, {.memory = o.texture_memory << 20});
  const JobReport report = run(o, job, *scene, farm, under_way);
  if (report.failure)
    throw Error(report.bad_input ? ExitCode::bad_input : ExitCode::job_failed, *report.failure);
  write(o, file, job, *scene, report);
  if (!o.quiet) summarise(job, report, file);
  return exit_code(job, report);
}

}  // namespace

std::function<int()> describe_render(CLI::App& app) {
  auto options = std::make_shared<RenderOptions>();
  describe(app, *options);
  return [options] {
    if (!options->list_devices) return render_scene(*options);
    return run_list_devices();
  };
}

}  // namespace tessera
