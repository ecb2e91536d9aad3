// SPDX-License-Identifier: Apache-2.0
// Compressed glTF: what the encoders of the libraries pack is what the scene holds.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include <algorithm>

#include "tests/core/scene/compressed.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;
using Triangle = std::array<std::uint32_t, 3>;

TEST(GltfMeshopt, AttributesAndTrianglesAreThoseThatWereEncoded) {
  const Scene scene = meshopt_square().load();
  EXPECT_THAT(scene.meshes.at(0).positions,
              ElementsAre(Vec3(0), Vec3(1, 0, 0), Vec3(1, 1, 0), Vec3(0, 1, 0)));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(GltfMeshopt, IndexSequencesAreRead) {
  GltfBuilder built;
  const int positions = built.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0}, "VEC3");
  const std::vector<std::uint32_t> strip{0, 1, 2, 3};
  std::string packed(meshopt_encodeIndexSequenceBound(4, 4), '\0');
  packed.resize(meshopt_encodeIndexSequence(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                            strip.data(), strip.size()));
  const int view = meshopt_view(built, packed, 4, 4, "INDICES", "NONE");
  const int indices = built.add(
      "accessors", {{"bufferView", view}, {"componentType", 5125}, {"count", 4}, {"type", "SCALAR"}});
  built.json["nodes"] = {
      {{"mesh", built.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}, {"mode", 5}})}}};
  EXPECT_THAT(built.load().meshes.at(0).triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
}

TEST(GltfMeshopt, FiltersAreUndone) {
  // Unit vectors in four bytes each: octahedral.
  const float normals[12] = {0, 0, 1, 0, 0.6f, 0, 0.8f, 0, -1, 0, 0, 0};
  std::vector<std::uint8_t> filtered(12);
  meshopt_encodeFilterOct(filtered.data(), 3, 4, 8, normals);
  GltfBuilder built;
  const int positions = built.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0}, "VEC3");
  const int view =
      meshopt_view(built, meshopt_packed(filtered.data(), 3, 4), 3, 4, "ATTRIBUTES", "OCTAHEDRAL");
  built.json["bufferViews"][static_cast<std::size_t>(view)]["byteStride"] = 4;
  const int accessor = built.add(
      "accessors",
      {{"bufferView", view}, {"componentType", 5120}, {"normalized", true}, {"count", 3}, {"type", "VEC3"}});
  built.json["nodes"] = {
      {{"mesh", built.mesh({{"attributes", {{"POSITION", positions}, {"NORMAL", accessor}}}})}}};
  const Mesh mesh = built.load().meshes.at(0);
  EXPECT_TRUE(mesh.normals[0].equalWithAbsError({0, 0, 1}, 0.02f)) << "8 bits";
  EXPECT_TRUE(mesh.normals[1].equalWithAbsError({0.6f, 0, 0.8f}, 0.02f));
  EXPECT_TRUE(mesh.normals[2].equalWithAbsError({-1, 0, 0}, 0.02f));
}

TEST(GltfMeshopt, BrokenViewsAreRefusedWithTheirPlace) {
  const auto refused_with = [](const char* key, const Json& value) {
    GltfBuilder built = meshopt_square();
    built.json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    return built.refused();
  };
  EXPECT_THAT(refused_with("count", 2'000'000'000),
              HasSubstr("bufferViews/0: 2000000000 elements cannot lie in"));
  EXPECT_THAT(refused_with("count", -1), HasSubstr("bufferViews/0: count is -1"));
  EXPECT_THAT(refused_with("byteLength", 1'000'000), HasSubstr("bufferViews/0: reaches beyond its buffer"));
  EXPECT_THAT(refused_with("byteLength", 20), HasSubstr("bufferViews/0: cannot be decoded"));
  EXPECT_THAT(refused_with("byteStride", 7), HasSubstr("do not go with ATTRIBUTES"));
  EXPECT_THAT(refused_with("mode", "ZIP"),
              HasSubstr("the mode is 'ZIP'; accepted: ATTRIBUTES, TRIANGLES or INDICES"));
  EXPECT_THAT(refused_with("filter", "QUATERNION"), HasSubstr("do not go with ATTRIBUTES"));
  EXPECT_THAT(refused_with("buffer", 9), HasSubstr("there is no buffer 9"));
}

// The corners of a mesh's triangles, whatever the order in which it is stored.
std::vector<std::array<float, 3>> corners_of(const Mesh& mesh) {
  std::vector<std::array<float, 3>> corners;
  for (const Triangle& t : mesh.triangles)
    for (const std::uint32_t v : t)
      corners.push_back({mesh.positions[v].x, mesh.positions[v].y, mesh.uvs[v].x});
  std::sort(corners.begin(), corners.end());
  return corners;
}

TEST(GltfDraco, TrianglesAndAttributesAreThoseThatWereEncoded) {
  const Scene scene = draco_square().load();
  ASSERT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.meshes[0].triangles.size(), 2u);
  EXPECT_EQ(corners_of(scene.meshes[0]),
            (std::vector<std::array<float, 3>>{
                {0, 0, 0}, {0, 0, 0}, {0, 1, 0}, {1, 0, 0.5f}, {1, 1, 1}, {1, 1, 1}}));
}

TEST(GltfDraco, BrokenDataIsRefusedWithItsPlace) {
  GltfBuilder built = draco_square();
  GltfBuilder cut = built;
  cut.json["bufferViews"][0]["byteLength"] = 30;
  EXPECT_THAT(cut.refused(), HasSubstr("meshes/0: the Draco data cannot be decoded"));
  cut.json["bufferViews"][0]["byteLength"] = 10;
  EXPECT_THAT(cut.refused(), HasSubstr("meshes/0: the Draco data has no whole head"));
  GltfBuilder huge = built;
  const std::string head("DRACO\2\2\1\1\0\0\0\4\xff\xff\xff\x7f", 17);  // 4 vertices, 2^28 - 1 faces
  huge.binary.replace(huge.json["bufferViews"][0]["byteOffset"].get<std::size_t>(), head.size(), head);
  EXPECT_THAT(huge.refused(), HasSubstr("268435455 faces and 4 vertices cannot lie in"));
  GltfBuilder nothing = built;
  nothing.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["attributes"]
              ["POSITION"] = 7;
  EXPECT_THAT(nothing.refused(), HasSubstr("meshes/0: the Draco data has no whole attribute 7 (POSITION)"));
  GltfBuilder lost = built;
  lost.json["meshes"][0]["primitives"][0]["extensions"]["KHR_draco_mesh_compression"]["bufferView"] = 5;
  EXPECT_THAT(lost.refused(), HasSubstr("bufferViews/5: there is no such buffer view"));
}

}  // namespace
}  // namespace tessera
