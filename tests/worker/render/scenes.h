// SPDX-License-Identifier: Apache-2.0
// Small scenes in code, and the statistics of what is rendered of them.
#pragma once

#include <cmath>
#include <functional>
#include <memory>

#include "core/film.h"
#include "worker/render/render.h"

namespace tessera::testing {

inline constexpr float kPi = 3.14159265358979f;

// A camera at `from` that looks at `to`, +Y up unless it looks along Y.
inline Camera camera_at(const Vec3& from, const Vec3& to, float vertical_fov) {
  const Vec3 back = (from - to).normalized();
  const Vec3 up = std::abs(back.y) > 0.99f ? Vec3(0, 0, 1) : Vec3(0, 1, 0);
  const Vec3 right = up.cross(back).normalized(), above = back.cross(right);
  Camera camera;
  camera.to_world = Matrix(right.x, right.y, right.z, 0, above.x, above.y, above.z, 0, back.x, back.y, back.z,
                           0, from.x, from.y, from.z, 1);
  camera.vertical_fov = vertical_fov;
  return camera;
}

// A grid of n x n squares in the plane spanned by two edges, front towards cross(a, b).
inline Mesh grid(const Vec3& corner, const Vec3& a, const Vec3& b, int n, int material) {
  Mesh mesh;
  mesh.material = material;
  const auto steps = static_cast<float>(n);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const Vec2 at(static_cast<float>(i) / steps, static_cast<float>(j) / steps);
      mesh.positions.push_back(corner + a * at.x + b * at.y);
      mesh.uvs.push_back(at);
    }
  const auto index = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1)});
      mesh.triangles.push_back({index(i, j), index(i + 1, j + 1), index(i, j + 1)});
    }
  return mesh;
}

inline int add_material(Scene& scene, const Material& material) {
  scene.materials.push_back(material);
  return static_cast<int>(scene.materials.size()) - 1;
}

inline void add_mesh(Scene& scene, Mesh mesh, const Matrix& to_world = Matrix()) {
  scene.meshes.push_back(std::move(mesh));
  scene.instances.push_back({static_cast<int>(scene.meshes.size()) - 1, to_world});
}

// A diffuse floor of 200 m through the origin, facing up.
inline void add_floor(Scene& scene, const Color& color) {
  const int material = add_material(scene, {.base_color = color});
  add_mesh(scene, grid({-100, 0, 100}, {200, 0, 0}, {0, 0, -200}, 1, material));
}

inline std::shared_ptr<const RenderScene> prepared(Scene scene) {
  return prepare(std::make_shared<const Scene>(std::move(scene)));
}

inline AovSet all_aovs() { return AovSet::all(); }

// Mean over all samples of a square frame, and the standard error of that mean, which treats pixels as
// independent and therefore overstates the error of stratified samples.
struct Measured {
  double mean[3], error[3];
};
inline Measured measure(const Scene& scene, int edge, int samples, int bounces, Aov aov = Aov::color,
                        std::uint64_t seed = 1) {
  RenderSettings settings{.size = {edge, edge}, .seed = seed, .max_bounces = bounces, .aovs = {aov}};
  const Block block = render(*prepared(scene), settings, 0, {0, 0, edge, edge}, {0, samples});
  const Image means = developed(block.sums, FilmLayout(settings.aovs), channels_of(aov), Part::all);
  Measured m;
  for (int c = 0; c < 3; ++c) {
    double sum = 0, squares = 0;
    const double n = static_cast<double>(edge) * edge;
    for (const float v : means.plane(c)) sum += v, squares += double(v) * v;
    m.mean[c] = sum / n;
    m.error[c] = std::sqrt(std::max(0.0, squares / n - m.mean[c] * m.mean[c]) / n);
  }
  return m;
}

}  // namespace tessera::testing
