// SPDX-License-Identifier: Apache-2.0
#include <algorithm>

#include "core/error.h"
#include "core/nearest.h"
#include "core/scene/import.h"
#include "core/scene/native/parts.h"

namespace tessera {
namespace {

LightTraits traits_of(Context& context, const Node& node) {
  LightTraits traits;
  override_traits(context, traits, node);
  return traits;
}

SpotLight read_spot(Context& context, const Node& node) {
  SpotLight light{node.point("position", Vec3(0)), node.direction("direction"),
                  node.color("intensity", Color(1))};
  light.inner_angle = node.angle("inner_angle", 0);
  light.outer_angle = node.angle("outer_angle", 45);
  light.light = traits_of(context, node);
  if (light.inner_angle > light.outer_angle)
    throw InputError(node.where(), "inner_angle is larger than outer_angle",
                     "0 <= inner_angle <= outer_angle");
  return light;
}

DirectionalLight read_sun(Context& context, const Node& node) {
  DirectionalLight light{node.direction("direction"), node.color("irradiance", Color(1)),
                         node.angle("angular_diameter", 0)};
  if (const auto visibility = node.find("visibility")) light.camera = visibility->flag("camera", true);
  light.light = traits_of(context, node);
  return light;
}

}  // namespace

void override_traits(Context& context, LightTraits& traits, const Node& node) {
  traits.diffuse = node.number("diffuse", traits.diffuse);
  traits.specular = node.number("specular", traits.specular);
  if (!node.has("group")) return;
  const std::string name = node.text("group", {});
  const std::string where = node.at("group").where();
  const auto& groups = context.scene.light_groups;
  if (context.groups_declared && std::find(groups.begin(), groups.end(), name) == groups.end()) {
    const std::vector<std::string_view> names(groups.begin(), groups.end());
    throw InputError(where, unknown("light group", name, names), listed(names));
  }
  traits.group = light_group(context.scene, name, where);
}

void add_light(Context& context, const Node& node) {
  Scene& scene = context.scene;
  const std::string type = node.text("type", {});
  if (type == "point")
    scene.points.push_back(
        {node.point("position", Vec3(0)), node.color("intensity", Color(1)), traits_of(context, node)});
  else if (type == "spot")
    scene.spots.push_back(read_spot(context, node));
  else
    scene.suns.push_back(read_sun(context, node));
}

Environment read_environment(Context& context, const Node& node) {
  Environment environment;
  environment.radiance = node.color("radiance", Color(1));
  environment.rotation = node.angle("rotation", 0);
  environment.light = traits_of(context, node);
  if (node.has("image"))
    environment.picture =
        context.shelf.place(node.path("image"), Encoding::srgb, node.at("image").where(), Keep::pixels);
  return environment;
}

Background read_background(const Node& node) {
  using Kind = Background::Kind;
  if (node.json->is_object()) return {Kind::color, node.color("color", Color(0))};
  return {node.json->text() == "transparent" ? Kind::transparent : Kind::environment, Color(0)};
}

}  // namespace tessera
