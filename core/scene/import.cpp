// SPDX-License-Identifier: Apache-2.0
#include "core/scene/import.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>

#include "core/error.h"
#include "core/scene/assimp/read.h"
#include "core/scene/files.h"
#include "core/scene/gltf/gltf.h"
#include "core/scene/native/native.h"
#include "core/scene/ply.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxWarnings = 200;

template <class T>
void move_to_end(std::vector<T>& all, std::vector<T>& part) {
  all.insert(all.end(), std::make_move_iterator(part.begin()), std::make_move_iterator(part.end()));
}

void shift_indices(Material& material, int pictures, int materials) {
  for (Texture* t : textures_of(material))
    if (*t) t->picture += pictures;
  if (material.kind != Material::Kind::mix) return;
  material.first += materials;
  material.second += materials;
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

// What rests moves with m; what is on a track is on one that moves with m.
void transform_all(Scene& part, const Matrix& m) {
  const auto rests = [&](int object) { return object < 0 || part.objects[std::size_t(object)].track < 0; };
  for (Instance& i : part.instances)
    if (rests(i.object)) i.to_world = i.to_world * m;
  for (Camera& c : part.cameras)
    if (c.track < 0) c.to_world = c.to_world * m;
  for (Track& t : part.tracks)
    for (Matrix& pose : t.poses) pose = pose * m;
  for (PointLight& l : part.points) l.position = l.position * m;
  for (SpotLight& l : part.spots) l.position = l.position * m, l.direction = turned(l.direction, m);
  for (DirectionalLight& l : part.suns) l.direction = turned(l.direction, m);
  for (Quad& q : part.quads) {
    const Vec3 u = (q.corner + q.edge_u) * m, v = (q.corner + q.edge_v) * m;
    q.corner = q.corner * m;
    q.edge_u = u - q.corner, q.edge_v = v - q.corner;
  }
  const float scale = std::cbrt(volume_scale(m));
  for (Sphere& s : part.spheres) s.center = s.center * m, s.radius *= scale;
  for (Disk& d : part.disks) d.center = d.center * m, d.normal = turned(d.normal, m), d.radius *= scale;
  if (!(part.spheres.empty() && part.disks.empty()) && !keeps_spheres_round(m))
    warn(part,
         fmt::format("{}: spheres and disks stay round though their transform is not uniform", part.name));
}

// Makes the indices of `part` those that its lists will have at the end of `scene`.
void shift_all(Scene& part, Scene& scene) {
  const auto count = [](const auto& list) { return static_cast<int>(list.size()); };
  const int materials = count(scene.materials), meshes = count(scene.meshes), tracks = count(scene.tracks),
            objects = count(scene.objects);
  const auto shift = [](int& index, int by) { index += index >= 0 ? by : 0; };
  const auto shift_light = [&](LightTraits& light) {
    if (light.group >= 0)
      light.group = light_group(scene, part.light_groups[std::size_t(light.group)], part.name);
  };
  const auto shift_shape = [&](auto& shape) {
    shape.material += materials;
    shift(shape.object, objects);
  };
  for (Material& m : part.materials) shift_indices(m, count(scene.pictures), materials);
  for (Mesh& m : part.meshes) m.material += materials;
  for (Object& o : part.objects) shift(o.track, tracks), shift_light(o.light);
  for (Instance& i : part.instances) i.mesh += meshes, shift(i.object, objects);
  for (Sphere& s : part.spheres) shift_shape(s);
  for (Quad& q : part.quads) shift_shape(q);
  for (Disk& d : part.disks) shift_shape(d);
  for (Camera& c : part.cameras) shift(c.track, tracks);
  for (PointLight& l : part.points) shift_light(l.light);
  for (SpotLight& l : part.spots) shift_light(l.light);
  for (DirectionalLight& l : part.suns) shift_light(l.light);
  for (Variant& v : part.variants)
    for (Variant::Choice& c : v.choices) c.mesh += meshes, c.material += materials;
}

// Takes what a file held from what those after it may hold.
void spend(ImportLimits& limits, const Scene& part) {
  const auto take = [](std::uint64_t& left, std::uint64_t n) { left -= std::min(left, n); };
  for (const Mesh& m : part.meshes) {
    take(limits.vertices, m.positions.size());
    take(limits.triangles, m.triangles.size());
  }
  take(limits.instances, part.instances.size());
  for (const Picture& p : part.pictures)
    take(limits.picture_pixels, static_cast<std::uint64_t>(p.width) * static_cast<std::uint64_t>(p.height));
}

// A file of a format that takes in no scenes.
Scene import_model(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where) {
  const std::string extension = extension_of(file);
  if (extension == ".gltf" || extension == ".glb") return read_gltf(file, limits, where);
  if (extension == ".obj" || extension == ".fbx") return read_with_assimp(file, limits, where);
  if (extension == ".ply") return read_ply(file, limits, where);
  throw InputError(where.empty() ? file.string() : where,
                   fmt::format("unknown kind of scene file '{}'", extension),
                   ".json, .gltf, .glb, .obj, .fbx, .ply");
}

}  // namespace

Scene import_scene(const std::filesystem::path& file, ImportBudget& budget, std::string_view where) {
  if (extension_of(file) == ".json") return read_native(file, budget, where);
  Scene scene = import_model(file, budget.limits, where);
  spend(budget.limits, scene);
  return scene;
}

std::array<Texture*, 11> textures_of(Material& m) {
  return {&m.base_color_texture,
          &m.metallic_roughness_texture,
          &m.normal_texture,
          &m.emission_texture,
          &m.transmission_texture,
          &m.clearcoat_texture,
          &m.clearcoat_roughness_texture,
          &m.clearcoat_normal_texture,
          &m.sheen_color_texture,
          &m.sheen_roughness_texture,
          &m.mix_texture};
}

int light_group(Scene& scene, const std::string& name, std::string_view where) {
  if (name.empty()) return -1;
  auto& groups = scene.light_groups;
  const auto at = std::find(groups.begin(), groups.end(), name);
  const int index = static_cast<int>(at - groups.begin());
  if (at != groups.end()) return index;
  if (index == kMaxLightGroups)
    throw InputError(where, fmt::format("'{}' is one light group too many", name),
                     fmt::format("at most {}", kMaxLightGroups));
  groups.push_back(name);
  return index;
}

void append(Scene& scene, Scene&& part, const Matrix& transform) {
  if (transform != Matrix()) transform_all(part, transform);  // or else the same bits
  shift_all(part, scene);
  move_to_end(scene.pictures, part.pictures);
  move_to_end(scene.materials, part.materials);
  move_to_end(scene.meshes, part.meshes);
  move_to_end(scene.tracks, part.tracks);
  move_to_end(scene.objects, part.objects);
  move_to_end(scene.instances, part.instances);
  move_to_end(scene.spheres, part.spheres);
  move_to_end(scene.quads, part.quads);
  move_to_end(scene.disks, part.disks);
  move_to_end(scene.points, part.points);
  move_to_end(scene.spots, part.spots);
  move_to_end(scene.suns, part.suns);
  move_to_end(scene.variants, part.variants);
  move_to_end(scene.cameras, part.cameras);
  move_to_end(scene.files, part.files);
  for (std::string& text : part.warnings) warn(scene, std::move(text));
}

void warn(Scene& scene, std::string text) {
  auto& all = scene.warnings;
  if (all.size() > kMaxWarnings || std::find(all.begin(), all.end(), text) != all.end()) return;
  all.push_back(all.size() == kMaxWarnings ? "more warnings are left out" : std::move(text));
}

Matrix z_up_to_y_up() { return {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1}; }

}  // namespace tessera
