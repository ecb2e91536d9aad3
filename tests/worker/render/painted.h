// SPDX-License-Identifier: Apache-2.0
// A square of one material to look at, for tests of what materials make of a point.
#pragma once

#include <utility>
#include <vector>

#include "tests/worker/render/scenes.h"
#include "worker/render/material.h"

namespace tessera::testing {

// A square in z = 0 facing +Z with u to the right and v down, as pictures lie on it. Its material is the
// last.
struct Painted {
  Scene scene;

  explicit Painted(std::vector<Material> materials, bool flipped = false) {
    scene.materials = std::move(materials);
    Mesh square = grid({-1, -1, 0}, {2, 0, 0}, {0, 2, 0}, 1, static_cast<int>(scene.materials.size()) - 1);
    for (Vec2& uv : square.uvs) uv = {flipped ? 1 - uv.x : uv.x, 1 - uv.y};
    add_mesh(scene, square);
  }
  explicit Painted(Material material, bool flipped = false)
      : Painted(std::vector<Material>{std::move(material)}, flipped) {}

  Material& material() { return scene.materials.back(); }
  Mesh& mesh() { return scene.meshes.back(); }
  int add_picture(int width, int channels, std::vector<float> pixels) {
    const int height = static_cast<int>(pixels.size()) / (width * channels);
    scene.pictures.push_back({"picture", width, height, channels, std::move(pixels)});
    return static_cast<int>(scene.pictures.size()) - 1;
  }

  // Calls look(materials, geometry, hit, surface) at a point seen from the direction `from`.
  template <typename Look>
  auto look(const Vec3& from, const Look& look) const {
    const tracer::Geometry geometry(scene);
    const tracer::Materials materials(scene);
    const tracer::Hit hit{0, 0, 0.3f, 0.3f};
    return look(materials, geometry, hit, geometry.surface(hit, from, tracer::unit(-from), 1));
  }
  // Borrows the sheen table from `materials`: for materials with sheen, keep that.
  tracer::Bsdf bsdf(const Vec3& from) const {
    return look(from, [&](const auto& materials, const auto& geometry, const auto& hit, const auto& s) {
      return materials.bsdf(geometry, hit, s, tracer::unit(-from));
    });
  }
  float opacity() const {
    return look({0, 0, 1}, [](const auto& materials, const auto& geometry, const auto& hit, const auto&) {
      return materials.opacity(geometry, hit);
    });
  }
};

}  // namespace tessera::testing
