// SPDX-License-Identifier: Apache-2.0
// Scenes of which the camera sees one point, as good as, and what it must see there.
#pragma once

#include <gtest/gtest.h>

#include <complex>
#include <utility>
#include <vector>

#include "tests/worker/render/scenes.h"

namespace tessera::testing {

inline constexpr double kViewCosine = 0.8;  // of the view to the normal

// A square of 200 m at height y, front up or down.
inline Mesh level(float y, int material, bool up = true) {
  return up ? grid({-100, y, 100}, {200, 0, 0}, {0, 0, -200}, 1, material)
            : grid({-100, y, -100}, {200, 0, 0}, {0, 0, 200}, 1, material);
}

// A wide level at height 0, of the last of the materials, whose origin the camera sees from `distance`: from
// the front, or if that is negative from below.
inline Scene origin_seen(std::vector<Material> materials, float distance = 0.5f) {
  Scene scene;
  scene.materials = std::move(materials);
  add_mesh(scene, level(0, static_cast<int>(scene.materials.size()) - 1));
  scene.cameras = {camera_at(Vec3(0.6f, 0.8f, 0) * distance, {0, 0, 0}, 1e-3f)};
  return scene;
}

inline Material emitter(const Color& radiance) {
  return {.base_color = Color(0, 0, 0), .emission = radiance};
}

// To 4 standard errors of the render and `slack`, relative, for floats.
inline void expect_radiance(const Scene& scene, const Imath::V3d& expected, const char* what, int bounces = 0,
                            int samples = 64, double slack = 1e-4) {
  const Measured m = measure(scene, 8, samples, bounces);
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(m.mean[c], expected[c], 4 * m.error[c] + slack * expected[c]) << what << ", channel " << c;
}

// Unpolarised reflectance of a boundary from index 1 to `index`, complex if it conducts: Fresnel's equations
// as in Born and Wolf 1999, section 1.5.2.
inline double fresnel_of(double cosine, std::complex<double> index) {
  const std::complex<double> beyond = std::sqrt(1.0 - (1 - cosine * cosine) / (index * index));
  const auto s = (cosine - index * beyond) / (cosine + index * beyond);
  const auto p = (index * cosine - beyond) / (index * cosine + beyond);
  return 0.5 * (std::norm(s) + std::norm(p));
}

// Of diffuse light.
inline double mean_fresnel_of(double index) {
  constexpr int kSteps = 20000;
  double sum = 0;
  for (int i = 0; i < kSteps; ++i)
    sum += 2 * ((i + 0.5) / kSteps) * fresnel_of((i + 0.5) / kSteps, index) / kSteps;
  return sum;
}

// What a pane of index n reflects and lets through: its sides reflect R, and between them light keeps the
// share a on each way; Stokes 1862, "On the Intensity of the Light Reflected from or Transmitted through a
// Pile of Plates".
struct Pane {
  double reflects, transmits;
};
inline Pane pane(double cosine, double n, double a) {
  const double r = fresnel_of(cosine, n), through = (1 - r) * (1 - r), series = 1 / (1 - r * r * a * a);
  return {r + r * through * a * a * series, through * a * series};
}

}  // namespace tessera::testing
