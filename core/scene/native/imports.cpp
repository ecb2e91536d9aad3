// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/imports.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace tessera {
namespace {

void drop_lights(Scene& scene) {
  scene.points.clear();
  scene.spots.clear();
  scene.suns.clear();
  scene.environment = {};
}

Matrix placement(const Node& node) {
  const Matrix up = node.text("up", "Y") == "Z" ? z_up_to_y_up() : Matrix();
  return then(up, transform_of(node));
}

[[noreturn]] void refuse_movements(const Node& node) {
  throw InputError(node.at("object").where(), "what is in the file moves, and cannot become one object",
                   "no `object`, or a file in which all rests");
}

// What is in `part` is to be one object: those that it has go.
void forget_objects(Scene& part, const Node& node) {
  const auto is_moving = [](const auto& thing) { return thing.track >= 0; };
  if (std::any_of(part.objects.begin(), part.objects.end(), is_moving) ||
      std::any_of(part.cameras.begin(), part.cameras.end(), is_moving))
    refuse_movements(node);
  part.objects.clear();
  for (Instance& i : part.instances) i.object = -1;
  for (Sphere& s : part.spheres) s.object = -1;
  for (Quad& q : part.quads) q.object = -1;
  for (Disk& d : part.disks) d.object = -1;
}

}  // namespace

Scene Imports::read(const Node& node) {
  const Node file = node.at("file");
  if (budget_.depth == 0)
    throw InputError(file.where(), "scenes import each other too deeply",
                     fmt::format("{} levels (limit depth)", budget_.limits.depth));
  if (--budget_.files < 0) throw InputError(file.where(), "too many files are imported", "10000 in all");
  --budget_.depth;
  Scene part = import_scene(node.path("file"), budget_, file.where());
  ++budget_.depth;
  if (node.has("object")) forget_objects(part, node);
  return part;
}

Imports::Ends Imports::ends() const {
  return {scene_.instances.size(), scene_.spheres.size(), scene_.quads.size(),
          scene_.disks.size(),     scene_.cameras.size(), scene_.points.size() + scene_.spots.size()};
}

void Imports::take_in(const Node& node) {
  Scene part = read(node);
  if (!node.flag("cameras", true)) part.cameras.clear();
  if (!node.flag("lights", true)) drop_lights(part);
  Environment environment = part.environment;
  if (environment.picture >= 0) environment.picture += static_cast<int>(scene_.pictures.size());
  if (environment.light.group >= 0)
    environment.light.group = light_group(
        scene_, part.light_groups[static_cast<std::size_t>(environment.light.group)], node.where());
  if (environment.picture >= 0 || environment.radiance != Color(0)) scene_.environment = environment;
  if (part.background.kind != Background::Kind::environment) scene_.background = part.background;
  if (part.frames_per_second != Scene{}.frames_per_second) scene_.frames_per_second = part.frames_per_second;
  const Ends begin = ends();
  add(std::move(part), placement(node));
  if (node.has("object")) joined_.push_back({node, begin, ends()});
}

std::vector<Instance> Imports::take_in_mesh(const std::string& name, const Node& node) {
  Scene part = read(node);
  part.cameras.clear();
  part.variants.clear();
  drop_lights(part);
  if (!part.spheres.empty() || !part.quads.empty() || !part.disks.empty())
    throw InputError(node.at("file").where(), "holds spheres, quads or disks, which are no mesh", "`import`");
  for (Mesh& mesh : part.meshes) mesh.name = name;
  const auto before = static_cast<std::ptrdiff_t>(scene_.instances.size());
  add(std::move(part), placement(node));
  const std::vector<Instance> instances(scene_.instances.begin() + before, scene_.instances.end());
  scene_.instances.resize(static_cast<std::size_t>(before));
  return instances;
}

void Imports::add(Scene&& part, const Matrix& transform) {
  of_file_.resize(scene_.tracks.size());
  append(scene_, std::move(part), transform);
  of_file_.resize(scene_.tracks.size(), true);
}

void Imports::join(const Library& library) {
  for (const auto& [node, begin, end] : joined_) {
    const int object = library.object(node);
    for (std::size_t i = begin.instances; i < end.instances; ++i) scene_.instances[i].object = object;
    const bool has_shapes = end.spheres > begin.spheres || end.quads > begin.quads || end.disks > begin.disks;
    const int shapes = has_shapes ? library.resting_object(node) : object;
    for (std::size_t i = begin.spheres; i < end.spheres; ++i) scene_.spheres[i].object = shapes;
    for (std::size_t i = begin.quads; i < end.quads; ++i) scene_.quads[i].object = shapes;
    for (std::size_t i = begin.disks; i < end.disks; ++i) scene_.disks[i].object = shapes;
    if (!moves(object)) continue;
    for (std::size_t i = begin.cameras; i < end.cameras; ++i)
      scene_.cameras[i].track = scene_.objects[static_cast<std::size_t>(object)].track;
    if (end.lights > begin.lights)
      warn(scene_, fmt::format("{}: the object moves, but the lights of the file rest", node.where()));
  }
}

bool Imports::moves(int object) const {
  return object >= 0 && scene_.objects[static_cast<std::size_t>(object)].track >= 0;
}

bool Imports::moved_by_file(int object) const {
  if (!moves(object)) return false;
  const auto track = static_cast<std::size_t>(scene_.objects[static_cast<std::size_t>(object)].track);
  return track < of_file_.size() && of_file_[track];
}

void Imports::place(const std::vector<Instance>& instances, const Matrix& transform, int object,
                    const Node& where) {
  for (const Instance& i : instances) {
    const bool by_file = moved_by_file(i.object);
    if (by_file && object >= 0) refuse_movements(where);
    // What the file moves is placed after it has moved; what we move, before.
    if (by_file && transform != Matrix())
      scene_.instances.push_back({i.mesh, i.to_world, moved_object(i.object, transform)});
    else
      scene_.instances.push_back({i.mesh, then(i.to_world, transform), object >= 0 ? object : i.object});
  }
}

int Imports::moved_object(int object, const Matrix& transform) {
  Object moved = scene_.objects[static_cast<std::size_t>(object)];
  Track track = scene_.tracks[static_cast<std::size_t>(moved.track)];
  for (Matrix& pose : track.poses) pose = pose * transform;
  moved.track = static_cast<int>(scene_.tracks.size());
  scene_.tracks.push_back(std::move(track));
  scene_.objects.push_back(std::move(moved));
  return static_cast<int>(scene_.objects.size()) - 1;
}

}  // namespace tessera
