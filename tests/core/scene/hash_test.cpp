// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <functional>
#include <set>

#include "core/scene/load.h"

namespace tessera {
namespace {

Scene full() {
  Scene s;
  s.pictures.push_back({"p", 1, 1, 3, {0.1f, 0.2f, 0.3f}});
  s.materials.emplace_back();
  s.meshes.push_back({"m",
                      {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}},
                      {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}},
                      {{0, 0}, {1, 0}, {0, 1}},
                      {{0, 1, 2}},
                      0});
  s.instances.push_back({0, Matrix()});
  s.spheres.emplace_back();
  s.points.emplace_back();
  s.spots.emplace_back();
  s.suns.emplace_back();
  s.cameras.emplace_back();
  return s;
}

TEST(ContentHash, DependsOnEveryFieldThatCanChangeAPixel) {
  const std::vector<std::function<void(Scene&)>> changes{
      [](Scene& s) { s.pictures[0].pixels[1] = 0.25f; },
      [](Scene& s) { s.pictures[0].channels = 1, s.pictures[0].width = 3; },
      [](Scene& s) { s.pictures[0].digest = "00"; },
      [](Scene& s) { s.pictures[0].encoding = Encoding::linear; },
      [](Scene& s) { s.pictures[0].tiles.push_back({"t"}); },
      [](Scene& s) { s.materials[0].kind = Material::Kind::mirror; },
      [](Scene& s) { s.materials[0].base_color.y = 0; },
      [](Scene& s) { s.materials[0].base_color_texture.picture = 0; },
      [](Scene& s) { s.materials[0].metallic_roughness_texture.picture = 0; },
      [](Scene& s) { s.materials[0].normal_texture.picture = 0; },
      [](Scene& s) { s.materials[0].emission_texture.picture = 0; },
      [](Scene& s) { s.materials[0].emission_texture.wrap_u = Texture::Wrap::clamp; },
      [](Scene& s) { s.materials[0].emission_texture.wrap_v = Texture::Wrap::clamp; },
      [](Scene& s) { s.materials[0].metallic = 0.5f; },
      [](Scene& s) { s.materials[0].roughness = 0.5f; },
      [](Scene& s) { s.materials[0].normal_scale = 0.5f; },
      [](Scene& s) { s.materials[0].emission.z = 1; },
      [](Scene& s) { s.materials[0].alpha = Material::Alpha::mask; },
      [](Scene& s) { s.materials[0].base_alpha = 0.25f; },
      [](Scene& s) { s.materials[0].alpha_cutoff = 0.25f; },
      [](Scene& s) { s.materials[0].ior = 1.25f; },
      [](Scene& s) { s.materials[0].eta.x = 1; },
      [](Scene& s) { s.materials[0].k.x = 1; },
      [](Scene& s) { s.materials[0].double_sided = false; },
      [](Scene& s) { s.meshes[0].positions[2].z = 1; },
      [](Scene& s) { s.meshes[0].normals.clear(); },
      [](Scene& s) { s.meshes[0].uvs[0].x = 1; },
      [](Scene& s) {
        s.meshes[0].triangles[0] = {0, 2, 1};
      },
      [](Scene& s) { s.meshes[0].material = 1; },
      [](Scene& s) { s.instances[0].to_world[3][0] = 1; },
      [](Scene& s) { s.instances[0].mesh = 1; },
      [](Scene& s) { s.spheres[0].radius = 2; },
      [](Scene& s) { s.spheres[0].center.x = 2; },
      [](Scene& s) { s.spheres[0].material = 2; },
      [](Scene& s) { s.points[0].position.x = 1; },
      [](Scene& s) { s.points[0].intensity.x = 2; },
      [](Scene& s) { s.spots[0].position.x = 1; },
      [](Scene& s) {
        s.spots[0].direction = {1, 0, 0};
      },
      [](Scene& s) { s.spots[0].intensity.x = 2; },
      [](Scene& s) { s.spots[0].inner_angle = 0.1f; },
      [](Scene& s) { s.spots[0].outer_angle = 0.1f; },
      [](Scene& s) {
        s.suns[0].direction = {1, 0, 0};
      },
      [](Scene& s) { s.suns[0].irradiance.x = 2; },
      [](Scene& s) { s.suns[0].angular_diameter = 0.1f; },
      [](Scene& s) { s.environment.radiance.x = 1; },
      [](Scene& s) { s.environment.picture = 0; },
      [](Scene& s) { s.environment.rotation = 1; },
      [](Scene& s) { s.cameras[0].name = "c"; },
      [](Scene& s) { s.cameras[0].to_world[3][0] = 1; },
      [](Scene& s) { s.cameras[0].vertical_fov = 1; },
      [](Scene& s) { s.cameras[0].horizontal_fov = 1; },
      [](Scene& s) { s.cameras[0].lens_radius = 1; },
      [](Scene& s) { s.cameras[0].focus_distance = 2; },
      [](Scene& s) { s.points.clear(); },
      [](Scene& s) { std::swap(s.meshes[0].normals, s.meshes[0].positions); }};
  std::set<std::string> hashes{content_hash(full())};
  for (std::size_t c = 0; c < changes.size(); ++c) {
    Scene scene = full();
    changes[c](scene);
    EXPECT_TRUE(hashes.insert(content_hash(scene)).second) << "change " << c;
  }
}

TEST(ContentHash, DependsOnNothingElse) {
  Scene scene = full();
  scene.name = "another";
  scene.materials[0].name = scene.meshes[0].name = scene.pictures[0].name = "another";
  scene.warnings.push_back("a warning");
  scene.meshes[0].positions.reserve(1000);
  EXPECT_EQ(content_hash(scene), content_hash(full()));
}

TEST(ContentHash, OfAnEmptySceneIsTheSha256OfItsBytes) {
  // Python, with f = lambda x: struct.pack("<f", x): hashlib.sha256(11 * 8 * b"\0" + 12 * b"\0" + 8 * b"\xff"
  // + 4 * b"\0" + 8 * b"\xff" + f(1) + f(1) + 20 * b"\0" + 16 * b"\0" + f(24) + 16 * b"\0"), i.e. eleven list
  // lengths, the environment (radiance, picture -1, rotation, light: group -1, two factors), the background,
  // light groups and tracks, the frame rate, variants and cameras.
  EXPECT_EQ(content_hash(Scene{}), "0174ee03171fd1885a17832d11a761553b262e49744fafb21a7b6a4ccb9935c5");
}

}  // namespace
}  // namespace tessera
