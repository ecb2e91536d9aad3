// SPDX-License-Identifier: Apache-2.0
#include "core/scene/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/scene/framing.h"
#include "core/scene/import.h"
#include "core/scene/tidy.h"

namespace tessera {
namespace {

constexpr float kMaxPower = 1e12f;  // of lights and emission: products with it stay finite

bool finite(const Matrix& m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  return true;
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

// To float precision: then there is nothing to mend, and loading what was saved changes no bit.
bool is_placement(const Matrix& m, const Vec3& x, const Vec3& y, const Vec3& z) {
  const auto same = [&](int row, const Vec3& axis) {
    return m[row][3] == 0 && (Vec3(m[row][0], m[row][1], m[row][2]) - axis).length() < 1e-6f;
  };
  return same(0, x) && same(1, y) && same(2, z) && m[3][3] == 1;
}

class Finisher {
 public:
  Finisher(Scene& scene, const std::string& file) : scene_(scene), file_(file) {}

  void finish() {
    for (Material& m : scene_.materials) finish_material(m);
    for (Mesh& m : scene_.meshes) finish_mesh(m);
    finish_instances();
    std::erase_if(scene_.spheres, [&](const Sphere& s) {
      return unusable("a sphere", finite(s.center) && s.radius > 0 && s.radius <= kMaxCoordinate);
    });
    finish_lights();
    for (Camera& c : scene_.cameras) finish_camera(c);
    if (scene_.cameras.empty()) scene_.cameras.push_back(framing_camera(scene_));
    if (scene_.instances.empty() && scene_.spheres.empty() && scene_.quads.empty() && scene_.disks.empty())
      warn_here("there is nothing to see: no triangles, spheres, quads or disks");
  }

 private:
  void warn_here(std::string_view what) { warn(scene_, fmt::format("{}: {}", file_, what)); }

  bool unusable(std::string_view what, bool usable) {
    if (!usable) warn_here(fmt::format("{} that is not finite or has no size is left out", what));
    return !usable;
  }

  void clamp(float& value, float low, float high, const Material& m, std::string_view field) {
    if (value >= low && value <= high) return;
    const float clamped = std::isnan(value) ? low : std::clamp(value, low, high);
    warn_here(fmt::format("material '{}': {} {:g} is taken for {:g}", m.name, field, value, clamped));
    value = clamped;
  }
  void clamp(Color& color, float low, float high, const Material& m, std::string_view field) {
    for (int c = 0; c < 3; ++c) clamp(color[c], low, high, m, field);
  }

  void finish_material(Material& m) {
    clamp(m.base_color, 0, 1, m, "base colour");
    clamp(m.metallic, 0, 1, m, "metallic");
    clamp(m.roughness, 0, 1, m, "roughness");
    clamp(m.normal_scale, -100, 100, m, "normal scale");
    clamp(m.emission, 0, kMaxPower, m, "emission");
    clamp(m.base_alpha, 0, 1, m, "alpha");
    clamp(m.alpha_cutoff, 0, 1, m, "alpha cutoff");
    clamp(m.ior, 1, 4, m, "ior");
    clamp(m.eta, 0, 100, m, "eta");
    clamp(m.k, 0, 100, m, "k");
  }

  void finish_mesh(Mesh& mesh) {
    if (mesh.triangles.size() > kMaxIndices / 3)
      throw InputError(file_, fmt::format("mesh '{}' has {} triangles", mesh.name, mesh.triangles.size()),
                       fmt::format("at most {}", kMaxIndices / 3));
    const Tidied tidied = tidy(mesh);
    if (tidied.not_finite > 0)
      warn_here(fmt::format(
          "mesh '{}': {} triangles with coordinates that are not finite or beyond {:g} are left out",
          mesh.name, tidied.not_finite, kMaxCoordinate));
    if (tidied.degenerate > 0)
      warn_here(
          fmt::format("mesh '{}': {} triangles without an area are left out", mesh.name, tidied.degenerate));
  }

  void finish_instances() {
    std::erase_if(scene_.instances, [&](const Instance& i) {
      const Mesh& mesh = scene_.meshes[static_cast<std::size_t>(i.mesh)];
      const bool flat = !finite(i.to_world) || !(std::abs(i.to_world.determinant()) > 0);
      return mesh.triangles.empty() || unusable(fmt::format("an instance of mesh '{}'", mesh.name), !flat);
    });
  }

  void finish_lights() {
    const auto power = [&](Color& c) {
      for (int i = 0; i < 3; ++i)
        if (!(c[i] >= 0 && c[i] <= kMaxPower)) {
          warn_here(fmt::format("a light of {:g} is taken for {:g}", c[i], c[i] > 0 ? kMaxPower : 0));
          c[i] = c[i] > 0 ? kMaxPower : 0;
        }
    };
    const auto is_direction = [](const Vec3& d) { return std::abs(d.length() - 1) < 1e-3f; };
    std::erase_if(scene_.points,
                  [&](const PointLight& l) { return unusable("a point light", finite(l.position)); });
    std::erase_if(scene_.spots, [&](const SpotLight& l) {
      return unusable("a spot light", finite(l.position) && is_direction(l.direction) && l.outer_angle > 0);
    });
    std::erase_if(scene_.suns, [&](const DirectionalLight& l) {
      return unusable("a directional light", is_direction(l.direction));
    });
    for (PointLight& l : scene_.points) power(l.intensity);
    for (SpotLight& l : scene_.spots) {
      power(l.intensity);
      l.outer_angle = std::min(l.outer_angle, 1.57079633f);  // KHR_lights_punctual: at most pi / 2
      l.inner_angle = l.inner_angle > 0 ? std::min(l.inner_angle, l.outer_angle) : 0;
    }
    for (DirectionalLight& l : scene_.suns) power(l.irradiance);
    power(scene_.environment.radiance);
  }

  // The axes of a camera become a rotation: a scaled camera sees what an unscaled one does.
  void finish_camera(Camera& camera) {
    const Matrix& m = camera.to_world;
    const Vec3 back = Vec3(m[2][0], m[2][1], m[2][2]).normalized();
    const Vec3 x = Vec3(m[1][0], m[1][1], m[1][2]).cross(back).normalized(), y = back.cross(x);
    if (finite(m) && is_placement(m, x, y, back)) return;
    if (!finite(m) || !(x.length() > 0.5f))
      throw InputError(file_,
                       fmt::format("the camera '{}' looks nowhere: its matrix is singular", camera.name));
    camera.to_world = {x.x,    x.y,    x.z,    0, y.x,     y.y,     y.z,     0,
                       back.x, back.y, back.z, 0, m[3][0], m[3][1], m[3][2], 1};
  }

  Scene& scene_;
  const std::string& file_;
};

}  // namespace

void finish(Scene& scene, const std::string& file) { Finisher(scene, file).finish(); }

}  // namespace tessera
