// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_job.h"

#include <spdlog/spdlog.h>

#include <algorithm>
#include <filesystem>

#include "core/error.h"
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
  if (s.job.filter.history() > 0) std::ranges::sort(s.frames);  // each goes by the one before
  return s;
}

}  // namespace tessera
