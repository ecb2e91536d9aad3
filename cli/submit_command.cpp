// SPDX-License-Identifier: Apache-2.0
// tessera submit: a scene and what is to be made of it, handed in to a farm.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <filesystem>
#include <memory>

#include "cli/farm_link.h"
#include "cli/fetching.h"
#include "cli/log_options.h"
#include "cli/render_options.h"
#include "cli/scene_job.h"
#include "cli/subcommand.h"
#include "core/scene/bundle_scene.h"
#include "proto/submission_codec.h"
#include "proto/upload.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

struct SubmitCommand {
  RenderOptions render;
  LinkOptions link;
  std::vector<std::string> roots, after;
  std::string job, name, output;
  int priority = 50;
  std::optional<double> limit_seconds, limit_samples;
  std::optional<std::uint64_t> limit_memory;
  bool wait = false;
};

// Whatever is submitted under the same name is the same job: submitting it again does nothing.
std::string job_name(const SubmitCommand& c) {
  if (c.job.empty()) return own_id(fs::path(c.render.scene).stem().string());
  if (!is_job_name(c.job))
    throw Error(ExitCode::bad_usage,
                fmt::format("--job: '{}'; accepted: 1 to 64 letters, digits, '-', '_', '.'", c.job));
  return c.job;
}

Submission submission_of(const SubmitCommand& c, const BundledScene& bundled) {
  Submission s = submission_of(c.render, bundled.scene);
  if (!c.name.empty()) s.name = c.name;
  s.priority = c.priority;
  s.after = c.after;
  s.limits.seconds = c.limit_seconds;
  if (c.limit_samples) s.limits.pixel_samples = static_cast<std::uint64_t>(*c.limit_samples);
  if (c.limit_memory) s.limits.bytes = *c.limit_memory << 20;
  s.job.scene.path = bundled.bundle.scene;
  s.job.scene.bundle = sha256(to_text(bundled.bundle));
  validate(s);
  return s;
}

// The files first, then the list of them, then the job, so that what is there is never without what it needs.
std::vector<BlobSource> blobs_of(const BundledScene& bundled, const std::string& submission) {
  std::vector<BlobSource> blobs;
  for (std::size_t i = 0; i < bundled.sources.size(); ++i)
    blobs.push_back(
        blob_of(bundled.sources[i], bundled.bundle.files[i].digest, bundled.bundle.files[i].bytes));
  blobs.push_back(blob_of(to_text(bundled.bundle)));
  blobs.push_back(blob_of(submission));
  return blobs;
}

int submit(SubmitCommand& c) {
  set_up_log(c.render.log);
  const JobName name = job_name(c);
  if (c.render.scene.empty())
    throw Error(ExitCode::bad_usage, "which scene? accepted: a .json, .gltf, .glb, .obj, .fbx or .ply file");
  const BundledScene bundled =
      load_bundled(c.render.scene, {c.roots.begin(), c.roots.end()}, c.render.limits);
  check_choices(c.render, bundled.scene);
  warn_of_few_samples(c.render);
  const std::string submission = encode(submission_of(c, bundled));
  FarmLink farm(c.link);
  const std::uint64_t sent = farm.client().upload(blobs_of(bundled, submission), upload_bar(c.render.quiet));
  spdlog::info("submit: {} bytes were uploaded", sent);
  farm.ask<Agreed>(Submit{name, sha256(submission)});
  fmt::print("{}\n", name);
  std::fflush(stdout);
  if (!c.wait && c.output.empty()) return 0;
  return static_cast<int>(
      fetch_job(farm, {.job = name, .output = c.output, .wait = true, .quiet = c.render.quiet}));
}

}  // namespace

std::function<int()> describe_submit(CLI::App& app) {
  auto c = std::make_shared<SubmitCommand>();
  describe_job(app, c->render);
  app.add_option("--job", c->job,
                 "Name by which the job is known [of the scene, and chance]; the same one again is no"
                 " second job");
  app.add_option("--name", c->name, "What people read [of the scene]");
  app.add_option("--priority", c->priority, "0 to 100; the higher, the sooner")
      ->check(CLI::Range(0, kHighestPriority))
      ->envname("TESSERA_PRIORITY")
      ->capture_default_str();
  app.add_option("--after", c->after, "Jobs that must be completed before")->delimiter(',');
  app.add_option("--root", c->roots,
                 "Folder, besides the scene file's, in which files of the scene may lie; repeatable");
  app.add_option("--limit-seconds", c->limit_seconds,
                 "The job is ended after so long, with the images it has")
      ->check(CLI::PositiveNumber);
  app.add_option("--limit-samples", c->limit_samples, "The same after so many pixel samples")
      ->check(CLI::PositiveNumber);
  app.add_option("--limit-memory", c->limit_memory, "MiB of the coordinator's that its frames may take");
  app.add_option("-o,--output", c->output, "Wait, and fetch the images: name.exr, of a shot name.####.exr")
      ->envname("TESSERA_OUTPUT");
  app.add_flag("--wait", c->wait, "End when the job does, with its exit code");
  app.add_flag("--quiet", c->render.quiet, "The job's name is all that is said");
  add_log_options(app, c->render.log);
  add_link_options(app, c->link);
  return [c] { return submit(*c); };
}

}  // namespace tessera
