// SPDX-License-Identifier: Apache-2.0
// tessera render: a local farm, one frame or many, files.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <cstdlib>
#include <exception>
#include <filesystem>

#include "cli/frame_files.h"
#include "cli/local_farm.h"
#include "cli/render_options.h"
#include "cli/render_output.h"
#include "cli/scene_job.h"
#include "cli/signals.h"
#include "cli/subcommand.h"
#include "cli/under_way.h"
#include "cli/version.h"
#include "cli/worse.h"
#include "coordinator/frame_writer.h"
#include "coordinator/resume.h"
#include "core/error.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

ProgressStyle progress_style(const RenderOptions& o) {
  if (o.quiet || o.progress == "none") return ProgressStyle::none;
  if (o.progress == "bar") return ProgressStyle::bar;
  if (o.progress == "lines") return ProgressStyle::lines;
  if (o.progress == "json") return ProgressStyle::json;
  if (o.progress == "openjd") return ProgressStyle::openjd;
  return usual_progress_style(isatty(STDERR_FILENO) != 0, std::getenv("OPENJD_SESSION_WORKING_DIR"));
}

fs::path output_of(const RenderOptions& o) {
  if (!o.output.empty()) return o.output;
  const fs::path scene = fs::path(o.scene).filename();
  return scene.stem().string() + (o.frames ? ".####.exr" : ".exr");
}

// What cannot fit is refused before anything is rendered.
void require_memory(const Job& job, std::size_t in_flight) {
  const double pages = static_cast<double>(sysconf(_SC_PHYS_PAGES)),
               page = static_cast<double>(sysconf(_SC_PAGESIZE));
  const double needed = frame_bytes(job) * static_cast<double>(in_flight), there = pages * page;
  if (needed > there)
    throw Error(
        ExitCode::out_of_memory,
        fmt::format("{} needs {:.1f} GiB, this machine has {:.1f}; try --crop or a smaller size",
                    in_flight == 1 ? "the frame" : "a shot, of which two frames are worked on at a time,",
                    needed / (1u << 30), there / (1u << 30)));
}

// Frames being rendered into files.
class Rendering {
 public:
  Rendering(const RenderOptions& o, const FrameFiles& files, const Scene& scene, const Submission& all)
      : o_(o),
        files_(files),
        style_(style_of(all, std::string(kVersion))),
        jobs_(jobs_of(all)),
        keys_(image_keys(jobs_)) {
    for (const Job& job : jobs_) require_foreign(files_.frame(job.frame), o_, scene);
    if (o_.frames)
      resume();
    else
      left_ = {0};
    for (const std::size_t i : left_) shot_.frames.push_back(jobs_[i]);
  }

  bool nothing_left() const { return left_.empty(); }
  // How it ended. Throws what became of the frame, if it was the only one.
  ExitCode ending() const {
    if (failure_) std::rethrow_exception(failure_);
    return ended_ < left_.size() ? ExitCode::interrupted : worst_;
  }

  void run(Coordinator& coordinator) {
    const ProgressStyle style = progress_style(o_);
    ProgressDisplay display(style, style == ProgressStyle::bar ? stderr : stdout);
    const JobWatcher watcher{.progress = [&](const Progress& p) { display.show(p); },
                             .interval = Millis{50},
                             .snapshot = [&](std::size_t i, const JobReport& r) { snapshot(left_[i], r); },
                             .finished = [&](std::size_t i, const JobReport& r) { finish(left_[i], r); }};
    coordinator.run(shot_, watcher);
  }

 private:
  // Leaves out what is there already.
  void resume() {
    std::vector<bool> done;
    for (std::size_t i = 0; i < jobs_.size(); ++i)
      done.push_back(files_.holds(jobs_[i].frame, file_key(keys_[i], style_)));
    const auto kept = files_.kept(jobs_.front());
    const Remaining r = remaining(jobs_, keys_, done, kept ? kept->key : "");
    left_ = r.frames;
    for (const std::size_t i : r.from_kept)
      shot_.histories[static_cast<std::size_t>(std::ranges::find(left_, i) - left_.begin())] = kept->planes;
    if (left_.size() < jobs_.size() && !o_.quiet)
      fmt::print("{} of {} frames are there already\n", jobs_.size() - left_.size(), jobs_.size());
  }

  void snapshot(std::size_t i, const JobReport& report) const try {
    write(files_.frame(jobs_[i].frame), jobs_[i], report, "");
  } catch (const Error& e) {
    spdlog::error("no snapshot: {}", e.what());  // the frame goes on
  }

  // A frame that failed, or cannot be written, does not keep the others from being done.
  void finish(std::size_t i, const JobReport& report) try {
    ++ended_;
    const Job& job = jobs_[i];
    const ExitCode code = exit_code(job, report);
    note(code);
    if (report.failure) throw Error(code, *report.failure);
    const fs::path file = files_.frame(job.frame);
    keys_[i] = key_as_made(jobs_, keys_, i, report.continued);
    const std::string key = code == ExitCode::interrupted ? "" : keys_[i];
    write(file, job, report, key);
    if (report.kept && !key.empty()) files_.keep({key, report.kept});
    if (!o_.quiet) summarise(job, report, file);
  } catch (const Error& e) {
    note(e.code());
    if (jobs_.size() == 1)
      failure_ = std::current_exception();
    else
      spdlog::error("frame {}: {}", jobs_[i].frame, e.what());
  }

  void write(const fs::path& file, const Job& job, const JobReport& report, const std::string& key) const {
    write_frame(file, fs::path(file).replace_extension(".png"), job, report, style_, key);
  }

  void note(ExitCode code) { worst_ = worse(worst_, code); }

  const RenderOptions& o_;
  const FrameFiles& files_;
  FrameStyle style_;
  std::vector<Job> jobs_;
  std::vector<std::string> keys_;  // of their images; of those that have ended, as they came to be
  std::vector<std::size_t> left_;  // of the jobs: still to be done
  Shot shot_;                      // of those
  std::size_t ended_ = 0;          // frames
  ExitCode worst_ = ExitCode::done;
  std::exception_ptr failure_;
};

int render_scene(const RenderOptions& o) {
  set_up_log(o.log);
  if (o.scene.empty())
    throw Error(ExitCode::bad_usage,
                "render: which scene? accepted: a .json, .gltf, .glb, .obj, .fbx or .ply file");
  const Job job = job_of(o);
  const FrameFiles files(output_of(o), o.frames.has_value());
  require_memory(job, o.frames ? Shot{}.in_flight : 1);

  UnderWay under_way;
  const Signals signals([&](int signal) { under_way.hear(signal); });
  const auto scene = std::make_shared<const Scene>(load_scene(o.scene, o.limits));
  check_choices(o, *scene);
  warn_of_few_samples(o);

  Rendering rendering(o, files, *scene, submission_of(o, *scene));
  if (rendering.nothing_left()) return static_cast<int>(ExitCode::done);
  LocalFarm farm(scene, o.threads.value_or(usable_threads()), o.device, {.memory = o.texture_memory << 20});
  {
    const UnderWay::Watch watch(under_way, farm.coordinator());
    rendering.run(farm.coordinator());
  }
  return static_cast<int>(rendering.ending());
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
