// SPDX-License-Identifier: Apache-2.0
// Lights, what surrounds the scene, and cameras.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/scene/finish_parts.h"
#include "core/scene/tidy.h"

namespace tessera::finishing {
namespace {

constexpr float kPi = 3.14159265358979323846f;

void finish_power(const Context& c, Color& power) {
  for (int i = 0; i < 3; ++i)
    if (!(power[i] >= 0 && power[i] <= kMaxPower)) {
      c.warn(fmt::format("a light of {:g} is taken for {:g}", power[i], power[i] > 0 ? kMaxPower : 0));
      power[i] = power[i] > 0 ? kMaxPower : 0;
    }
}

void finish_surroundings(const Context& c) {
  Environment& environment = c.scene.environment;
  finish_power(c, environment.radiance);
  c.require_index(environment.picture, c.scene.pictures.size(), true, "the environment", "picture");
  c.require_light(environment.light, "the environment");
  c.clamp(environment.rotation, -1e6f, 1e6f, "the environment", "rotation");
  c.clamp(c.scene.background.color, 0, kMaxPower, "the background", "colour");
}

// To float precision: then there is nothing to mend, and loading what was saved changes no bit.
bool is_placement(const Matrix& m, const Vec3& x, const Vec3& y, const Vec3& z) {
  const auto same = [&](int row, const Vec3& axis) {
    return m[row][3] == 0 && (Vec3(m[row][0], m[row][1], m[row][2]) - axis).length() < 1e-6f;
  };
  return same(0, x) && same(1, y) && same(2, z) && m[3][3] == 1;
}

// The axes of a camera become a rotation: a scaled camera sees what an unscaled one does.
void finish_axes(const Context& c, Camera& camera) {
  const Matrix& m = camera.to_world;
  const Vec3 back = Vec3(m[2][0], m[2][1], m[2][2]).normalized();
  const Vec3 x = Vec3(m[1][0], m[1][1], m[1][2]).cross(back).normalized(), y = back.cross(x);
  if (finite(m) && is_placement(m, x, y, back)) return;
  if (!finite(m) || !(x.length() > 0.5f))
    c.refuse(fmt::format("the camera '{}' looks nowhere: its matrix is singular", camera.name));
  camera.to_world = {x.x,    x.y,    x.z,    0, y.x,     y.y,     y.z,     0,
                     back.x, back.y, back.z, 0, m[3][0], m[3][1], m[3][2], 1};
}

void finish_camera(const Context& c, Camera& camera) {
  const std::string owner = fmt::format("camera '{}'", camera.name);
  finish_axes(c, camera);
  c.require_index(camera.track, c.scene.tracks.size(), true, owner, "track");
  const bool is_wide = camera.horizontal_fov > 0;
  const float fov = is_wide ? camera.horizontal_fov : camera.vertical_fov;
  if (camera.projection == Camera::Projection::perspective && !(fov > 0 && fov < kPi))
    c.refuse(fmt::format("{}: the field of view is {} radians", owner, fov), "above 0, below pi");
  const float extent = camera.width > 0 ? camera.width : camera.height;
  if (camera.projection == Camera::Projection::orthographic && !(extent > 0 && extent <= kMaxCoordinate))
    c.refuse(fmt::format("{}: it sees {} metres", owner, extent), "above 0");
  c.clamp(camera.lens_radius, 0, kMaxCoordinate, owner, "lens radius");
  c.clamp(camera.focus_distance, 1e-6f, kMaxCoordinate, owner, "focus distance");
  c.clamp(camera.blade_rotation, -1e6f, 1e6f, owner, "blade rotation");
  camera.blades = std::clamp(camera.blades, 0, 1000);
  c.clamp(camera.shutter_open, -1, 1, owner, "shutter opening");
  c.clamp(camera.shutter_close, camera.shutter_open, 1, owner, "shutter closing");
}

}  // namespace

void finish_lights(const Context& c) {
  Scene& scene = c.scene;
  std::erase_if(scene.points,
                [&](const PointLight& l) { return c.unusable("a point light", finite(l.position)); });
  std::erase_if(scene.spots, [&](const SpotLight& l) {
    return c.unusable("a spot light", finite(l.position) && is_direction(l.direction) && l.outer_angle > 0);
  });
  std::erase_if(scene.suns, [&](const DirectionalLight& l) {
    return c.unusable("a directional light", is_direction(l.direction));
  });
  for (PointLight& l : scene.points) {
    finish_power(c, l.intensity);
    c.require_light(l.light, "a point light");
  }
  for (SpotLight& l : scene.spots) {
    finish_power(c, l.intensity);
    c.require_light(l.light, "a spot light");
    l.outer_angle = std::min(l.outer_angle, kPi / 2);  // KHR_lights_punctual: at most pi / 2
    l.inner_angle = l.inner_angle > 0 ? std::min(l.inner_angle, l.outer_angle) : 0;
  }
  for (DirectionalLight& l : scene.suns) {
    finish_power(c, l.irradiance);
    c.require_light(l.light, "a directional light");
    c.clamp(l.angular_diameter, 0, kPi, "a directional light", "angular diameter");
  }
  finish_surroundings(c);
}

void finish_cameras(const Context& c) {
  for (Camera& camera : c.scene.cameras) finish_camera(c, camera);
}

}  // namespace tessera::finishing
