// SPDX-License-Identifier: Apache-2.0
// The parts of a native scene file as JSON: each undoes one of parts.h. Fields that are what the reader takes
// for granted are left out.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "core/scene/json.h"
#include "core/scene/scene.h"

namespace tessera {

// What things are called in the file: by index, all different.
struct Names {
  std::vector<std::string> materials, meshes, objects;
};
Names names_of(const Scene&);

// An object that is being put together.
struct Members {
  Json::Object list;
  void add(std::string key, Json value) { list.push_back({std::move(key), std::move(value)}); }
  void add_number(std::string key, float value, float standard);
  void add_angle(std::string key, float radians, float standard);
  void add_color(std::string key, const Color& value, const Color& standard);
  Json done() { return {std::move(list)}; }
};

Json number(double v);
Json text(std::string v);
Json array_of(const float* values, std::size_t count);
Json point(const Vec3&);
Json degrees(float radians);  // that the reader takes for exactly these radians
Json matrix(const Matrix&);

std::string relative_to(const std::filesystem::path& folder, const std::filesystem::path& file);

Json material_json(const Scene&, const Names&, const Material&, const std::filesystem::path& folder,
                   bool with_textures);
Json mesh_json(const Names&, const Mesh&, bool placed);
Json object_json(const Scene&, const Object&, const std::string& key);
Json camera_json(const Scene&, const Camera&);
Json point_light_json(const Scene&, const PointLight&);
Json spot_json(const Scene&, const SpotLight&);
Json sun_json(const Scene&, const DirectionalLight&);
Json environment_json(const Scene&, const std::filesystem::path& folder);
Json background_json(const Background&);

}  // namespace tessera
