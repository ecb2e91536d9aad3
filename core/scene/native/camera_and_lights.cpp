// SPDX-License-Identifier: Apache-2.0
#include "core/error.h"
#include "core/scene/native/parts.h"

namespace tessera {
namespace {

constexpr float kDefaultFov = 40.0f;  // degrees

// Rows: the camera's axes and position. It looks along its own -Z.
Matrix looking(const Node& look) {
  const Vec3 from = look.point("from", Vec3(0)), to = look.point("to", Vec3(0)),
             up = look.point("up", Vec3(0, 1, 0));
  const Vec3 back = (from - to).normalized();
  const Vec3 right = up.normalized().cross(back);
  if (from == to) throw InputError(look.where(), "`from` and `to` are the same point", "two points apart");
  if (right.length() < 1e-6f)
    throw InputError(look.where(), "`up` points along the view", "another direction");
  const Vec3 x = right.normalized(), y = back.cross(x);
  return {x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, back.x, back.y, back.z, 0, from.x, from.y, from.z, 1};
}

}  // namespace

Camera read_camera(const Node& node) {
  Camera camera;
  camera.name = node.text("name", {});
  if (const auto look = node.find("look_at")) {
    camera.to_world = looking(*look);
    camera.focus_distance = (look->point("to", Vec3(0)) - look->point("from", Vec3(0))).length();
  } else {
    camera.to_world = node.matrix("matrix");
  }
  camera.horizontal_fov = radians(node.number("horizontal_fov", 0));
  camera.vertical_fov = node.has("horizontal_fov") ? 0 : radians(node.number("vertical_fov", kDefaultFov));
  camera.lens_radius = node.number("lens_radius", 0);
  camera.focus_distance = node.number("focus_distance", camera.focus_distance);
  return camera;
}

void add_light(Scene& scene, const Node& node) {
  const std::string type = node.text("type", {});
  if (type == "point") {
    scene.points.push_back({node.point("position", Vec3(0)), node.color("intensity", Color(1))});
  } else if (type == "spot") {
    SpotLight light{node.point("position", Vec3(0)), node.direction("direction"),
                    node.color("intensity", Color(1))};
    light.inner_angle = radians(node.number("inner_angle", 0));
    light.outer_angle = radians(node.number("outer_angle", 45));
    if (light.inner_angle > light.outer_angle)
      throw InputError(node.where(), "inner_angle is larger than outer_angle",
                       "0 <= inner_angle <= outer_angle");
    scene.spots.push_back(light);
  } else {
    scene.suns.push_back({node.direction("direction"), node.color("irradiance", Color(1)),
                          radians(node.number("angular_diameter", 0))});
  }
}

Environment read_environment(const Node& node, PictureShelf& shelf) {
  Environment environment;
  environment.radiance = node.color("radiance", Color(1));
  environment.rotation = radians(node.number("rotation", 0));
  if (node.has("image"))
    environment.picture =
        shelf.place(node.path("image"), Encoding::srgb, node.at("image").where(), Keep::pixels);
  return environment;
}

}  // namespace tessera
