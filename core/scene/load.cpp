// SPDX-License-Identifier: Apache-2.0
#include "core/scene/load.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/nearest.h"
#include "core/scene/files.h"
#include "core/scene/finish.h"
#include "core/scene/import.h"
#include "embedded_schema.h"

namespace tessera {
namespace {

bool has_light(const Scene& scene) {
  return !scene.points.empty() || !scene.spots.empty() || !scene.suns.empty() ||
         scene.environment.radiance != Color(0) ||
         std::any_of(scene.materials.begin(), scene.materials.end(),
                     [](const Material& m) { return m.emission != Color(0); });
}

// A native file says what lights it has; models from elsewhere often have none.
void light_up(Scene& scene, const std::filesystem::path& file) {
  if (has_light(scene)) return;
  if (extension_of(file) == ".json")
    return warn(scene, file.string() + ": there is no light: everything is black");
  scene.environment.radiance = Color(1);
  warn(scene, file.string() + ": there is no light: an environment of radiance 1 lights it");
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, const ImportLimits& limits) {
  ImportBudget budget;
  budget.limits = limits;
  Scene scene = import_scene(file, budget);
  require_at_most(limits.instances, scene.instances.size(), "instances", file.string());
  finish(scene, file.string());
  light_up(scene, file);
  return scene;
}

std::string_view scene_schema() { return embedded_schema::scene_schema_json; }

int camera_index(const Scene& scene, std::string_view name) {
  if (name.empty()) return 0;
  std::vector<std::string_view> names;
  for (const Camera& camera : scene.cameras) {
    if (camera.name == name) return static_cast<int>(names.size());
    names.push_back(camera.name);
  }
  throw InputError(scene.name, unknown("camera", name, names), listed(names));
}

}  // namespace tessera
