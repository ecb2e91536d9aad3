// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_job.h"

#include <fmt/ranges.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "core/error.h"
#include "core/scene/cuts.h"
#include "core/scene/facts.h"
#include "core/scene/load.h"
#include "core/sequence.h"

namespace tessera {
namespace {

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& t : things) names.push_back(t.name);
  return names;
}

// Cuts that are told, and those that the camera makes; all are said, and which frames have none before them.
std::vector<int> cuts_in(const RenderOptions& o, const Scene& scene, const std::vector<int>& frames) {
  const Camera& camera = scene.cameras[static_cast<std::size_t>(camera_index(scene, o.camera))];
  std::vector<int> cuts = cuts_of(scene, camera, frames);
  if (!cuts.empty()) spdlog::info("the camera jumps: frames that start anew: {}", fmt::join(cuts, ", "));
  if (!o.cuts.empty()) std::ranges::copy(parse_frames(o.cuts), std::back_inserter(cuts));
  std::ranges::sort(cuts);
  cuts.erase(std::ranges::unique(cuts).begin(), cuts.end());
  const auto gaps = std::ranges::count_if(
      frames, [&](int f) { return f != frames.front() && !std::ranges::binary_search(frames, f - 1); });
  if (gaps > 0)
    spdlog::warn("{} of {} frames start anew: the frames before them are not among --frames", gaps,
                 frames.size());
  return cuts;
}

}  // namespace

void check_choices(const RenderOptions& o, const Scene& scene) {
  for (const std::string& warning : scene.warnings) spdlog::warn("{}", warning);
  camera_index(scene, o.camera);
  variant_of(scene, o.variant);
}

Submission submission_of(const RenderOptions& o, const Scene& scene) {
  Submission s{.name = std::filesystem::path(o.scene).filename().string(),
               .job = job_of(o),
               .frames = o.frames ? parse_frames(*o.frames) : std::vector{o.frame},
               .facts = facts_of(scene),
               .names = {.light_groups = scene.light_groups,
                         .objects = names_of(scene.objects),
                         .materials = names_of(scene.materials)},
               .transparent = scene.background.kind == Background::Kind::transparent,
               .compression = o.compression,
               .exposure = o.exposure,
               .layers_for = o.layers_for};
  s.job.render.aovs = s.job.render.aovs | groups_of(o, scene.light_groups.size());
  s.job.scene.hash = content_hash(scene);
  if (s.job.filter.history() > 0) {  // each goes by the one before
    std::ranges::sort(s.frames);
    s.cuts = cuts_in(o, scene, s.frames);
  } else if (!o.cuts.empty()) {
    throw Error(ExitCode::bad_usage, "--cuts: only with a filter that has history=on");
  }
  return s;
}

}  // namespace tessera
