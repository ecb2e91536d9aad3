// SPDX-License-Identifier: Apache-2.0
#include "core/scene/load.h"

#include <fmt/format.h>

#include <algorithm>
#include <unordered_set>

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

void forget_repeats(std::vector<std::string>& files) {
  std::unordered_set<std::string> known;
  std::erase_if(files, [&](const std::string& file) { return !known.insert(file).second; });
}

}  // namespace

Scene load_scene(const std::filesystem::path& file, const ImportLimits& limits) {
  ImportBudget budget{limits};
  Scene scene = import_scene(file, budget);
  require_at_most(limits.instances, scene.instances.size(), "instances", file.string());
  forget_repeats(scene.files);
  finish(scene, file.string());
  light_up(scene, file);
  return scene;
}

std::string_view scene_schema() { return embedded_schema::scene_schema_json; }

namespace {

template <typename T>
std::size_t index_of(const std::vector<T>& things, std::string_view kind, std::string_view name,
                     const std::string& scene) {
  std::vector<std::string_view> names;
  for (const T& t : things) {
    if (t.name == name) return names.size();
    names.push_back(t.name);
  }
  throw InputError(scene, unknown(kind, name, names), listed(names));
}

}  // namespace

int camera_index(const Scene& scene, std::string_view name) {
  if (name.empty()) return 0;
  return static_cast<int>(index_of(scene.cameras, "camera", name, scene.name));
}

const Variant* variant_of(const Scene& scene, std::string_view name) {
  if (name.empty()) return nullptr;
  return &scene.variants[index_of(scene.variants, "variant", name, scene.name)];
}

}  // namespace tessera
