// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"
#include "core/scene/files.h"
#include "core/scene/gltf/gltf.h"
#include "core/scene/native/native.h"
#include "core/scene/obj.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxWarnings = 200;

template <class T>
void move_to_end(std::vector<T>& all, std::vector<T>& part) {
  all.insert(all.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
}

void shift_pictures(Material& material, int by) {
  for (Texture* t : {&material.base_color_texture, &material.metallic_roughness_texture,
                     &material.normal_texture, &material.emission_texture})
    if (*t) t->picture += by;
}

Vec3 turned(const Vec3& direction, const Matrix& transform) {
  Vec3 result;
  transform.multDirMatrix(direction, result);
  return result.normalized();
}

float volume_scale(const Matrix& m) {
  return std::abs(
      Vec3(m[0][0], m[0][1], m[0][2]).cross({m[1][0], m[1][1], m[1][2]}).dot({m[2][0], m[2][1], m[2][2]}));
}

bool keeps_spheres_round(const Matrix& m) {
  const float x = Vec3(m[0][0], m[0][1], m[0][2]).length(), y = Vec3(m[1][0], m[1][1], m[1][2]).length(),
              z = Vec3(m[2][0], m[2][1], m[2][2]).length();
  return std::max({x, y, z}) - std::min({x, y, z}) <= 1e-4f * std::max({x, y, z});
}

void transform_all(Scene& part, const Matrix& m) {
  for (Instance& i : part.instances) i.to_world = i.to_world * m;
  for (Camera& c : part.cameras) c.to_world = c.to_world * m;
  for (PointLight& l : part.points) l.position = l.position * m;
  for (SpotLight& l : part.spots) l.position = l.position * m, l.direction = turned(l.direction, m);
  for (DirectionalLight& l : part.suns) l.direction = turned(l.direction, m);
  for (Sphere& s : part.spheres) s.center = s.center * m, s.radius *= std::cbrt(volume_scale(m));
  if (!part.spheres.empty() && !keeps_spheres_round(m))
    warn(part, fmt::format("{}: spheres stay spheres though their transform is not uniform", part.name));
}

}  // namespace

Scene import_scene(const std::filesystem::path& file, ImportBudget& budget, std::string_view where) {
  const std::string extension = extension_of(file);
  if (extension == ".json") return read_native(file, budget, where);
  if (extension == ".gltf" || extension == ".glb") return read_gltf(file, where);
  if (extension == ".obj") return read_obj(file, where);
  throw InputError(where.empty() ? file.string() : where,
                   fmt::format("unknown kind of scene file '{}'", extension), ".json, .gltf, .glb, .obj");
}

void append(Scene& scene, Scene&& part, const Matrix& transform) {
  transform_all(part, transform);
  const int pictures = static_cast<int>(scene.pictures.size()),
            materials = static_cast<int>(scene.materials.size()),
            meshes = static_cast<int>(scene.meshes.size());
  for (Material& m : part.materials) shift_pictures(m, pictures);
  for (Mesh& m : part.meshes) m.material += materials;
  for (Sphere& s : part.spheres) s.material += materials;
  for (Instance& i : part.instances) i.mesh += meshes;
  move_to_end(scene.pictures, part.pictures);
  move_to_end(scene.materials, part.materials);
  move_to_end(scene.meshes, part.meshes);
  move_to_end(scene.instances, part.instances);
  move_to_end(scene.spheres, part.spheres);
  move_to_end(scene.points, part.points);
  move_to_end(scene.spots, part.spots);
  move_to_end(scene.suns, part.suns);
  move_to_end(scene.cameras, part.cameras);
  for (std::string& text : part.warnings) warn(scene, std::move(text));
}

void warn(Scene& scene, std::string text) {
  auto& all = scene.warnings;
  if (all.size() > kMaxWarnings || std::find(all.begin(), all.end(), text) != all.end()) return;
  all.push_back(all.size() == kMaxWarnings ? "more warnings are left out" : std::move(text));
}

Matrix z_up_to_y_up() { return {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}; }

}  // namespace tessera
