// SPDX-License-Identifier: Apache-2.0
// Irradiance at a point, measured by sampling lights alone, by hits alone, and by both weighed together,
// without the integrator; and what it is in closed form.
#pragma once

#include <gtest/gtest.h>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/one_ray.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/warp.h"

namespace tessera::testing {

using namespace tracer;  // NOLINT
using Imath::V3d;

inline const Vec3 kAt(0.2f, -0.1f, 0.3f);
inline constexpr int kMany = 40000;

struct Mean {
  double sum = 0, squares = 0;
  void add(double v) { sum += v, squares += v * v; }
  double mean() const { return sum / kMany; }
  double error() const { return std::sqrt(std::max(0.0, squares / kMany - mean() * mean()) / kMany); }
};
struct Irradiance {
  Mean by_light, by_hit, by_both;
};

inline double total(const RenderScene& scene, const Vertex& from, const Vec3& d, float time) {
  double sum = 0;
  const auto seen = look(scene, from.position, d, {.time = time, .kind = RayKind::scattered});
  if (!seen)
    scene.lights().escaped(from, d, [&](const Emitted& e) { sum += e.radiance.x; });
  else if (seen->surface.light >= 0)
    sum = scene.lights().hit(from, d, seen->surface).radiance.x;
  return sum;
}

inline Irradiance measured(const RenderScene& scene, const Vec3& n, const Vec3& at = kAt) {
  Random random(53);
  Irradiance e;
  for (int i = 0; i < kMany; ++i) {
    const float time = random.number(), pick = random.number();
    const LightSample l = scene.lights().sample(at, n, pick, random.pair(), time);
    const float cosine = l.pdf > 0 ? dot(n, l.direction) : 0;
    double light = 0, weight = 1;
    if (cosine > 0) {
      const bool hidden = l.infinite ? blocked(scene, at, l.direction, kEndless, {time, RayKind::shadow})
                                     : blocked(scene, at, l.target - at, 1, {time, RayKind::shadow});
      light = hidden ? 0 : l.radiance.x * cosine / l.pdf;
      if (!l.delta) weight = power_heuristic(l.pdf, cosine * kInvPi);
    }
    e.by_light.add(light);
    const Vec3 local = cosine_hemisphere(random.pair()), d = Frame(n).to_world(local);
    e.by_hit.add(kPi * total(scene, {at, n, 0}, d, time));
    e.by_both.add(light * weight +
                  (local.z > 0 ? kPi * total(scene, {at, n, local.z * kInvPi}, d, time) : 0));
  }
  return e;
}

inline void expect_all(const Scene& scene, const Vec3& n, double expected, const char* what,
                       const Vec3& at = kAt, double slack = 1e-5) {
  const Irradiance e = measured(RenderScene(std::make_shared<const Scene>(scene), {0, 1}), n, at);
  EXPECT_NEAR(e.by_light.mean(), expected, 4 * e.by_light.error() + slack * expected) << what << ", lights";
  EXPECT_NEAR(e.by_hit.mean(), expected, 4 * e.by_hit.error() + slack * expected) << what << ", hits";
  EXPECT_NEAR(e.by_both.mean(), expected, 4 * e.by_both.error() + slack * expected) << what << ", both";
}

// What only sampling finds.
inline void expect_sampled(const Scene& scene, const Vec3& n, double expected, const char* what) {
  const Irradiance e = measured(*prepared(scene), n);
  EXPECT_NEAR(e.by_light.mean(), expected, 4 * e.by_light.error() + 1e-5 * expected) << what;
  EXPECT_NEAR(e.by_both.mean(), expected, 4 * e.by_both.error() + 1e-5 * expected) << what;
  EXPECT_EQ(e.by_hit.mean(), 0) << what;
}

inline Scene with_lamp(bool double_sided = false) {
  Scene scene;
  add_material(scene, {.emission = Color(2, 2, 2), .double_sided = double_sided});
  return scene;
}

// Irradiance by a polygon of radiance 2 that is all above the horizon; Lambert 1760, as in Arvo 1995,
// "Applications of Irradiance Tensors to the Simulation of Non-Lambertian Phenomena", section 3.
inline double polygon(const std::vector<V3d>& corners, const Vec3& n, const Vec3& at = kAt) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d a = (corners[i] - V3d(at)).normalized(),
              b = (corners[(i + 1) % corners.size()] - V3d(at)).normalized();
    sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(V3d(n));
  }
  return std::abs(sum);  // 2 / 2 times
}
inline double polygon(const Quad& q, const Vec3& n) {
  const V3d c(q.corner), u(q.edge_u), v(q.edge_v);
  return polygon({c, c + u, c + u + v, c + v}, n);
}

inline const Quad kRectangle{{-1, 2, -0.5f}, {2.5f, 0, 0}, {0, 0.5f, 2}};  // front down
inline const Quad kParallelogram{{-1, 2, -0.5f}, {2.5f, 0.4f, 0.6f}, {0, 0.5f, 2}};

// Disk parallel to the surface, its centre `a` to the side and `h` above; Howell, A Catalog of Radiation
// Configuration Factors, B-13.
inline double disk_factor(double r, double h, double a) {
  const double z = a * a + h * h + r * r;
  return 0.5 * (1 - (a * a + h * h - r * r) / std::sqrt(z * z - 4 * a * a * r * r));
}

}  // namespace tessera::testing
