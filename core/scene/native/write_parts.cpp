// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/write_parts.h"

#include "core/scene/native/node.h"

namespace tessera {
namespace {

void add_traits(Members& members, const Scene& scene, const LightTraits& traits) {
  if (traits.group >= 0)
    members.add("group", text(scene.light_groups[static_cast<std::size_t>(traits.group)]));
  members.add_number("diffuse", traits.diffuse, 1);
  members.add_number("specular", traits.specular, 1);
}

template <class Lists>
Json lists_of(const Lists& lists) {
  Json::Array array;
  for (const auto& list : lists) array.push_back(array_of(&list[0], sizeof(list) / sizeof(float)));
  return {std::move(array)};
}

Json triangles_of(const Mesh& mesh) {
  Json::Array array;
  for (const auto& t : mesh.triangles) {
    Json::Array corners;
    for (const std::uint32_t v : t) corners.push_back(number(v));
    array.push_back({std::move(corners)});
  }
  return {std::move(array)};
}

Json keys_of(const Track& track) {
  Json::Array keys;
  for (std::size_t i = 0; i < track.times.size(); ++i) {
    Members key;
    key.add("time", number(track.times[i]));
    key.add("matrix", matrix(track.poses[i]));
    keys.push_back(key.done());
  }
  return {std::move(keys)};
}

void add_view(Members& members, const Camera& c) {
  using Projection = Camera::Projection;
  if (c.projection == Projection::orthographic && c.width > 0)
    members.add("width", number(c.width));
  else if (c.projection == Projection::orthographic)
    members.add("height", number(c.height));
  if (c.projection == Projection::perspective && c.horizontal_fov > 0)
    members.add("horizontal_fov", degrees(c.horizontal_fov));
  else if (c.projection == Projection::perspective)
    members.add("vertical_fov", degrees(c.vertical_fov));
  if (c.projection == Projection::panorama) return;
  members.add_number("lens_radius", c.lens_radius, 0);
  if (c.blades != 0) members.add("blades", number(c.blades));
  members.add_angle("blade_rotation", c.blade_rotation, 0);
  members.add("focus_distance", c.autofocus ? text("auto") : number(c.focus_distance));
}

}  // namespace

Json mesh_json(const Names& names, const Mesh& mesh, bool placed) {
  Members members;
  members.add("material", text(names.materials[static_cast<std::size_t>(mesh.material)]));
  if (!placed) members.add("placed", {false});
  members.add("positions", lists_of(mesh.positions));
  members.add("triangles", triangles_of(mesh));
  if (!mesh.normals.empty()) members.add("normals", lists_of(mesh.normals));
  if (!mesh.uvs.empty()) members.add("uvs", lists_of(mesh.uvs));
  if (!mesh.uvs2.empty()) members.add("uvs2", lists_of(mesh.uvs2));
  if (!mesh.colors.empty()) members.add("colors", lists_of(mesh.colors));
  return members.done();
}

Json object_json(const Scene& scene, const Object& object, const std::string& key) {
  Members members, visibility, light;
  if (object.name != key) members.add("name", text(object.name));
  if (!object.camera) visibility.add("camera", {false});
  if (!object.scattered) visibility.add("scattered", {false});
  if (!object.shadow) visibility.add("shadow", {false});
  if (!visibility.list.empty()) members.add("visibility", visibility.done());
  if (object.catcher) members.add("shadow_catcher", {true});
  add_traits(light, scene, object.light);
  if (!light.list.empty()) members.add("light", light.done());
  if (object.track >= 0) members.add("keys", keys_of(scene.tracks[static_cast<std::size_t>(object.track)]));
  return members.done();
}

Json camera_json(const Scene& scene, const Camera& c) {
  using Projection = Camera::Projection;
  Members members, shutter;
  if (!c.name.empty()) members.add("name", text(c.name));
  if (c.projection != Projection::perspective)
    members.add("projection", text(c.projection == Projection::orthographic ? "orthographic" : "panorama"));
  if (c.track < 0 || c.to_world != Matrix()) members.add("matrix", matrix(c.to_world));
  if (c.track >= 0) members.add("keys", keys_of(scene.tracks[static_cast<std::size_t>(c.track)]));
  add_view(members, c);
  shutter.add_number("open", c.shutter_open, 0);
  shutter.add_number("close", c.shutter_close, 0);
  if (!shutter.list.empty()) members.add("shutter", shutter.done());
  return members.done();
}

Json point_light_json(const Scene& scene, const PointLight& l) {
  Members members;
  members.add("type", text("point"));
  members.add("position", point(l.position));
  members.add_color("intensity", l.intensity, Color(1));
  add_traits(members, scene, l.light);
  return members.done();
}

Json spot_json(const Scene& scene, const SpotLight& l) {
  Members members;
  members.add("type", text("spot"));
  members.add("position", point(l.position));
  members.add("direction", point(l.direction));
  members.add_color("intensity", l.intensity, Color(1));
  members.add_angle("inner_angle", l.inner_angle, 0);
  members.add_angle("outer_angle", l.outer_angle, radians(45));
  add_traits(members, scene, l.light);
  return members.done();
}

Json sun_json(const Scene& scene, const DirectionalLight& l) {
  Members members, visibility;
  members.add("type", text("directional"));
  members.add("direction", point(l.direction));
  members.add_color("irradiance", l.irradiance, Color(1));
  members.add_angle("angular_diameter", l.angular_diameter, 0);
  if (!l.camera) {
    visibility.add("camera", {false});
    members.add("visibility", visibility.done());
  }
  add_traits(members, scene, l.light);
  return members.done();
}

Json environment_json(const Scene& scene, const std::filesystem::path& folder) {
  const Environment& e = scene.environment;
  Members members;
  members.add_color("radiance", e.radiance, Color(1));
  if (e.picture >= 0)
    members.add("image", text(relative_to(folder, scene.pictures[static_cast<std::size_t>(e.picture)].name)));
  members.add_angle("rotation", e.rotation, 0);
  add_traits(members, scene, e.light);
  return members.done();
}

Json background_json(const Background& background) {
  if (background.kind == Background::Kind::transparent) return text("transparent");
  if (background.kind == Background::Kind::environment) return text("environment");
  Members members;
  members.add("color", array_of(&background.color.x, 3));
  return members.done();
}

}  // namespace tessera
