// SPDX-License-Identifier: Apache-2.0
// Known values from a glTF file, as text and as binary.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <regex>

#include "core/scene/pictures.h"
#include "tests/core/scene/folder.h"
#include "tests/core/scene/glb.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::StartsWith;

class Gltf : public testing::Test {
 protected:
  const Scene scene_ = load_scene(kData / "card.gltf");
  const Folder folder_;

  // Why the card is refused once every match of `pattern` in it is `replacement`.
  std::string refusal_with(const std::string& pattern, const std::string& replacement) const {
    const std::string text = contents(kData / "card.gltf");
    const std::string changed = std::regex_replace(text, std::regex(pattern), replacement);
    EXPECT_NE(changed, text) << pattern;
    folder_.write("corners.png", contents(kData / "corners.png"));
    return refusal(folder_.write("card.gltf", changed));
  }
};

TEST_F(Gltf, PrimitivesAreMeshesThatInstancesShare) {
  ASSERT_EQ(scene_.meshes.size(), 2u);
  EXPECT_EQ(scene_.meshes[0].positions[2], Vec3(1, 2, 0));
  EXPECT_EQ(scene_.meshes[0].normals[3], Vec3(0, 0, 1));
  EXPECT_EQ(scene_.meshes[0].uvs[0], Vec2(0, 1));
  EXPECT_EQ(scene_.meshes[0].triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
  EXPECT_TRUE(scene_.meshes[1].normals.empty());
  ASSERT_EQ(scene_.instances.size(), 4u);
  EXPECT_EQ(scene_.instances[0].to_world.translation(), Vec3(10, 0, 0));
  // Scaled by 2, a quarter turn about Y (x to -z), moved by (0, 1, 0) and by the parent's (10, 0, 0).
  EXPECT_TRUE((Vec3(1, 2, 0) * scene_.instances[2].to_world).equalWithAbsError({10, 5, -2}, 1e-5f));
}

TEST_F(Gltf, MaterialsKeepTheirFactorsAndTextures) {
  const Material& paper = scene_.materials[0];
  EXPECT_EQ(paper.kind, Material::Kind::metallic_roughness);
  EXPECT_EQ(paper.base_color, Color(0.5f, 0.25f, 1));
  EXPECT_EQ(paper.base_alpha, 0.75f);
  EXPECT_EQ(paper.metallic, 0.125f);
  EXPECT_EQ(paper.roughness, 0.5f);
  EXPECT_EQ(paper.normal_scale, 0.5f);
  EXPECT_EQ(paper.emission, Color(8, 4, 0));
  EXPECT_EQ(paper.alpha, Material::Alpha::mask);
  EXPECT_EQ(paper.alpha_cutoff, 0.25f);
  EXPECT_TRUE(paper.double_sided);
  EXPECT_EQ(paper.base_color_texture.wrap_u, Texture::Wrap::clamp);
  EXPECT_EQ(paper.base_color_texture.wrap_v, Texture::Wrap::mirror);
  EXPECT_EQ(scene_.materials[1].transmission, 1);
  EXPECT_TRUE(scene_.materials[1].thin) << "it has no volume";
  EXPECT_EQ(scene_.materials[1].ior, 1.25f);
  EXPECT_FALSE(scene_.materials[1].double_sided);
  EXPECT_THAT(scene_.warnings, testing::IsEmpty());
}

TEST_F(Gltf, OnePictureInTwoRolesIsDecodedInTwoWays) {
  const Material& paper = scene_.materials[0];
  ASSERT_NE(paper.base_color_texture.picture, paper.normal_texture.picture);
  const auto grey = [&](const Texture& t) {
    return with_pixels(scene_.pictures[static_cast<std::size_t>(t.picture)]).pixels[12];
  };
  EXPECT_FLOAT_EQ(grey(paper.normal_texture), 188.0f / 255);
  EXPECT_NEAR(grey(paper.base_color_texture), std::pow((188.0 / 255 + 0.055) / 1.055, 2.4), 1e-6);
}

TEST_F(Gltf, LightsAndCamerasStandWhereTheirNodesDo) {
  EXPECT_EQ(scene_.points[0].position, Vec3(1, 2, 3));
  EXPECT_EQ(scene_.points[0].intensity, Color(4, 2, 1));
  EXPECT_TRUE(scene_.spots[0].direction.equalWithAbsError({0, -1, 0}, 1e-6f));
  EXPECT_EQ(scene_.spots[0].outer_angle, 0.5f);
  EXPECT_EQ(scene_.suns[0].direction, Vec3(0, 0, -1));
  EXPECT_EQ(scene_.suns[0].irradiance, Color(3));
  EXPECT_EQ(scene_.cameras[0].name, "eye");
  EXPECT_EQ(scene_.cameras[0].to_world.translation(), Vec3(0, 1, 5));
  EXPECT_FLOAT_EQ(scene_.cameras[0].vertical_fov, 0.8f);
}

TEST_F(Gltf, TheBinaryFormIsTheSameScene) {
  folder_.write("corners.png", contents(kData / "corners.png"));
  const Scene binary = load_scene(folder_.write("card.glb", glb_of(contents(kData / "card.gltf"), {})));
  EXPECT_EQ(content_hash(binary), content_hash(scene_));
}

TEST_F(Gltf, ImagesMayLieInABuffer) {
  const Scene scene = load_scene(folder_.write("card.glb", glb_with_embedded_image()));
  EXPECT_EQ(scene.pictures.at(0).width, 2);
  EXPECT_THAT(scene.pictures[0].name, testing::EndsWith("card.glb#images/0"));
}

TEST_F(Gltf, WhatReachesBeyondItsBytesIsRefused) {
  EXPECT_THAT(refusal_with("\"count\": 4", "\"count\": 5"), StartsWith("card.gltf#accessors/"));
  EXPECT_THAT(refusal_with("\"count\": 6", "\"count\": 4000000"),
              HasSubstr("its 4000000 elements reach beyond the buffer view"));
  EXPECT_THAT(refusal_with("\"count\": 6", "\"count\": 4000000000"),
              HasSubstr("there are 1333333333 triangles; accepted: at most 536870912"));
  EXPECT_THAT(refusal_with("\"byteLength\": 96", "\"byteLength\": 9600"),
              HasSubstr("reaches beyond its buffer"));
  EXPECT_THAT(refusal_with("\"byteOffset\": 48", "\"byteOffset\": 18446744073709551615"),
              StartsWith("card.gltf"));
  EXPECT_THAT(refusal_with("\"bufferView\": 0", "\"bufferView\": 77"), StartsWith("card.gltf"));
}

TEST_F(Gltf, IndicesOutOfRangeAreRefused) {
  // The four UV pairs read as shorts: 0 and 16256 (half of the float 1).
  EXPECT_THAT(refusal_with("\"bufferView\": 2", "\"bufferView\": 1"), HasSubstr("uses vertex 16256 of 4"));
  EXPECT_THAT(refusal_with("\"material\": 1", "\"material\": 9"), HasSubstr("there is no material 9"));
  EXPECT_THAT(refusal_with("\"mesh\": 0", "\"mesh\": 9"), HasSubstr("there is no mesh 9"));
  EXPECT_THAT(refusal_with("\"camera\": 0", "\"camera\": 9"), HasSubstr("there is no camera 9"));
  EXPECT_THAT(refusal_with("\"light\": 0", "\"light\": 9"), HasSubstr("there is no light 9"));
  EXPECT_THAT(refusal_with("\"scene\": 0", "\"scene\": 9"), HasSubstr("there is no scene 9"));
  EXPECT_THAT(refusal_with("\"source\": 0", "\"source\": 9"), HasSubstr("images/9"));
}

TEST_F(Gltf, NodesInACircleAreRefused) {
  EXPECT_THAT(refusal_with("\"name\": \"plain\",", R"("children": [0],)"),
              HasSubstr("is among its own children"));
}

TEST_F(Gltf, DeepJsonIsRefused) {
  const std::string deep = std::string(100'000, '[') + std::string(100'000, ']');
  EXPECT_THAT(refusal_with("\"asset\": \\{", "\"extras\": " + deep + ", \"asset\": {"),
              HasSubstr("nested deeper"));
}

TEST_F(Gltf, AMissingImageIsRefusedByName) {
  EXPECT_THAT(refusal_with("corners.png", "nowhere.png"), HasSubstr("nowhere.png: no such file"));
}

TEST_F(Gltf, RequiredExtensionsWeLackAreRefused) {
  EXPECT_THAT(refusal_with("\"scene\": 0", R"("extensionsRequired": ["KHR_texture_basisu"], "scene": 0)"),
              HasSubstr("requires the extension 'KHR_texture_basisu'; accepted: EXT_mesh_gpu_instancing, "));
}

}  // namespace
}  // namespace tessera
