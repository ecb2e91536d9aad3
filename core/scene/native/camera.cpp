// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <initializer_list>

#include "core/error.h"
#include "core/scene/native/parts.h"

namespace tessera {
namespace {

using Projection = Camera::Projection;
constexpr std::array<std::pair<std::string_view, Projection>, 3> kProjections{
    {{"perspective", Projection::perspective},
     {"orthographic", Projection::orthographic},
     {"panorama", Projection::panorama}}};

constexpr double kDefaultFov = 40;                         // degrees
constexpr double kPictureHeight = 24, kPictureWidth = 36;  // millimetres: of 35 mm film

void refuse_keys(const Node& node, std::string_view projection, std::initializer_list<const char*> keys) {
  for (const char* key : keys)
    if (node.has(key))
      throw InputError(node.at(key).where(),
                       fmt::format("'{}' means nothing to the projection {}", key, projection));
}

void refuse_what_means_nothing(const Node& node, Projection projection) {
  if (projection != Projection::perspective)
    refuse_keys(node, node.text("projection", {}),
                {"vertical_fov", "horizontal_fov", "focal_length", "f_stop"});
  if (projection != Projection::orthographic)
    refuse_keys(node, node.text("projection", "perspective"), {"height", "width"});
  if (projection == Projection::panorama)
    refuse_keys(node, "panorama", {"lens_radius", "blades", "blade_rotation", "focus_distance"});
}

// What lets a pinhole camera have this field of view on a picture of 35 mm film; metres.
double focal_length(const Node& node, const Camera& camera) {
  if (node.has("focal_length")) return node.at("focal_length").json->number() / 1000;
  return camera.horizontal_fov > 0 ? kPictureWidth / 2000 / std::tan(camera.horizontal_fov / 2.0)
                                   : kPictureHeight / 2000 / std::tan(camera.vertical_fov / 2.0);
}

void read_view(Camera& camera, const Node& node) {
  camera.height = node.number("height", camera.height);
  camera.width = node.number("width", camera.width);
  if (camera.projection == Projection::perspective) {
    camera.horizontal_fov = node.angle("horizontal_fov", 0);
    camera.vertical_fov = node.has("horizontal_fov") ? 0 : node.angle("vertical_fov", kDefaultFov);
    if (const auto focal = node.find("focal_length"))
      camera.vertical_fov = static_cast<float>(2 * std::atan(kPictureHeight / 2 / focal->json->number()));
  }
}

void read_lens(Camera& camera, const Node& node) {
  camera.lens_radius = node.number("lens_radius", 0);
  if (const auto stop = node.find("f_stop"))
    camera.lens_radius = static_cast<float>(focal_length(node, camera) / (2 * stop->json->number()));
  camera.blades = node.integer("blades", 0);
  camera.blade_rotation = node.angle("blade_rotation", 0);
  const auto focus = node.find("focus_distance");
  camera.autofocus = focus && focus->json->is_text();
  if (focus && !camera.autofocus) camera.focus_distance = static_cast<float>(focus->json->number());
}

void read_shutter(Camera& camera, const Node& shutter) {
  camera.shutter_open = shutter.number("open", 0);
  camera.shutter_close = shutter.number("close", 0);
  if (camera.shutter_open > camera.shutter_close)
    throw InputError(shutter.where(), "the shutter closes before it opens", "open <= close");
}

float distance(const Node& look) {
  return (look.point("to", Vec3(0)) - look.point("from", Vec3(0))).length();
}

}  // namespace

Camera read_camera(Context& context, const Node& node) {
  Camera camera;
  camera.name = node.text("name", {});
  camera.projection = named(kProjections, node.text("projection", "perspective"));
  refuse_what_means_nothing(node, camera.projection);
  std::optional<Node> look = node.find("look_at");
  if (look) camera.to_world = looking(*look);
  if (node.has("matrix")) camera.to_world = node.matrix("matrix");
  if (const auto keys = node.find("keys")) {
    camera.track = add_track(context.scene, *keys);
    if (!look && !node.has("matrix")) look = keys->items().front().find("look_at");
  }
  const auto focus = node.find("focus_distance");
  if (look && camera.projection != Projection::panorama && !focus) camera.focus_distance = distance(*look);
  read_view(camera, node);
  read_lens(camera, node);
  if (const auto shutter = node.find("shutter")) read_shutter(camera, *shutter);
  return camera;
}

}  // namespace tessera
