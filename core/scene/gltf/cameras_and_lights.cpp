// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/cameras_and_lights.h"

#include <fmt/format.h>

#include "core/scene/gltf/values.h"

namespace tessera::gltf {

Camera camera_of(const Document& document, const tinygltf::Node& node) {
  const std::string part = fmt::format("cameras/{}", node.camera);
  const auto& all = document.model.cameras;
  const tinygltf::Camera& from =
      all[checked(document, node.camera, all.size(), fmt::format("camera {}", node.camera), part)];
  Camera camera;
  camera.name = node.name.empty() ? from.name : node.name;
  if (from.type == "orthographic") {
    camera.projection = Camera::Projection::orthographic;
    camera.height = static_cast<float>(2 * from.orthographic.ymag);  // ymag is half of what is seen
    if (!(camera.height > 0 && camera.height < 1e12f))
      document.refuse(part, fmt::format("ymag is {}", from.orthographic.ymag), "metres above 0");
  } else {
    camera.vertical_fov = static_cast<float>(from.perspective.yfov);
    if (!(camera.vertical_fov > 0 && camera.vertical_fov < 3.1f))
      document.refuse(part, fmt::format("yfov is {}", from.perspective.yfov), "radians above 0, below 3.1");
  }
  return camera;
}

void add_light(Scene& scene, const Document& document, const tinygltf::Value& extension, const Matrix& world,
               const std::string& part) {
  const int index = integer(extension, "light").value_or(-1);
  const auto& all = document.model.lights;
  const tinygltf::Light& light =
      all[checked(document, index, all.size(), fmt::format("light {}", index), part)];
  Color power(static_cast<float>(light.intensity));
  if (light.color.size() == 3)
    for (int c = 0; c < 3; ++c) power[c] *= static_cast<float>(light.color[static_cast<std::size_t>(c)]);
  const Vec3 position = world.translation(),
             direction = Vec3(-world[2][0], -world[2][1], -world[2][2]).normalized();
  if (light.range > 0) document.warn(scene, "the range of a light is ignored: light reaches everywhere");
  if (light.type == "point")
    scene.points.push_back({position, power});
  else if (light.type == "directional")
    scene.suns.push_back({direction, power});
  else if (light.type == "spot")
    scene.spots.push_back({position, direction, power, static_cast<float>(light.spot.innerConeAngle),
                           static_cast<float>(light.spot.outerConeAngle)});
  else
    document.warn(scene, fmt::format("a light of type '{}' is left out", light.type));
}

}  // namespace tessera::gltf
