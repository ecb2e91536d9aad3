// SPDX-License-Identifier: Apache-2.0
// Meshes, nodes and cameras of glTF.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/scene/gltf_builder.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using Json = nlohmann::json;
using Triangle = std::array<std::uint32_t, 3>;

// A node that shows a mesh of one primitive.
GltfBuilder built_with(GltfBuilder built, const Json& primitive) {
  built.json["nodes"] = {{{"mesh", built.mesh(primitive)}}};
  return built;
}

TEST(GltfPrimitive, StripsAlternateTheirWindingAndFansTurnAboutTheFirst) {
  GltfBuilder built;
  const int positions = built.accessor<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0, 0, 2, 0}, "VEC3");
  const auto triangles = [&](int mode) {
    return built_with(built, {{"attributes", {{"POSITION", positions}}}, {"mode", mode}})
        .load()
        .meshes[0]
        .triangles;
  };
  EXPECT_THAT(triangles(5), ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}, Triangle{2, 3, 4}));
  EXPECT_THAT(triangles(6), ElementsAre(Triangle{1, 2, 0}, Triangle{2, 3, 0}, Triangle{3, 4, 0}));
}

TEST(GltfPrimitive, PointsAndLinesAreLeftOutInWords) {
  GltfBuilder built;
  const int square = built.square();
  for (const int mode : {0, 1, 2, 3}) {
    const Scene scene = built_with(built, {{"attributes", {{"POSITION", square}}}, {"mode", mode}}).load();
    EXPECT_TRUE(scene.meshes.empty());
    EXPECT_TRUE(scene.objects.empty());
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("points or lines (mode " + std::to_string(mode) + ")")));
  }
}

TEST(GltfPrimitive, IndicesOfEverySizeAreReadAndEachIsChecked) {
  const auto check = [](auto zero) {
    using T = decltype(zero);
    GltfBuilder built;
    const int square = built.square();
    const int good = built.accessor<T>({0, 1, 2, 0, 2, 3}, "SCALAR");
    EXPECT_THAT(built_with(built, {{"attributes", {{"POSITION", square}}}, {"indices", good}})
                    .load()
                    .meshes[0]
                    .triangles,
                ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
    const int bad = built.accessor<T>({0, 1, 4}, "SCALAR");
    EXPECT_THAT(built_with(built, {{"attributes", {{"POSITION", square}}}, {"indices", bad}}).refused(),
                HasSubstr("uses vertex 4 of 4"));
  };
  check(std::uint8_t{});
  check(std::uint16_t{});
  check(std::uint32_t{});
}

TEST(GltfPrimitive, ColoursAreLinearAndIntegersOfThemNormalized) {
  GltfBuilder built;
  const int square = built.square();
  const auto colors = [&](int accessor) {
    return built_with(built, {{"attributes", {{"POSITION", square}, {"COLOR_0", accessor}}}, {"mode", 6}})
        .load()
        .meshes[0]
        .colors;
  };
  EXPECT_EQ(colors(built.accessor<std::uint8_t>({255, 51, 0, 102, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC4",
                                                true))[0],
            (std::array<float, 4>{1, 0.2f, 0, 0.4f}));
  EXPECT_EQ(colors(built.accessor<float>({0.5f, 0.25f, 1, 0, 0, 0, 0, 0, 0, 0, 0, 0}, "VEC3"))[0],
            (std::array<float, 4>{0.5f, 0.25f, 1, 1}));
  const int few = built.accessor<float>({0, 0, 0}, "VEC3");
  EXPECT_THAT(built_with(built, {{"attributes", {{"POSITION", square}, {"COLOR_0", few}}}}).refused(),
              HasSubstr("meshes/0: COLOR_0 has 1 elements; accepted: 4, as POSITION has"));
}

TEST(GltfPrimitive, TwoSetsOfCoordinatesAreKeptAndMoreNamed) {
  GltfBuilder built;
  const int square = built.square(), first = built.accessor<float>({0, 0, 1, 0, 1, 1, 0, 1}, "VEC2"),
            second = built.accessor<std::uint16_t>({0, 0, 65535, 0, 0, 0, 0, 0}, "VEC2", true);
  const Scene scene = built_with(built, {{"attributes",
                                          {{"POSITION", square},
                                           {"TEXCOORD_0", first},
                                           {"TEXCOORD_1", second},
                                           {"TEXCOORD_2", second},
                                           {"TANGENT", first},
                                           {"_TEMPERATURE", first}}},
                                         {"mode", 6}})
                          .load();
  EXPECT_EQ(scene.meshes[0].uvs[2], Vec2(1, 1));
  EXPECT_EQ(scene.meshes[0].uvs2[1], Vec2(1, 0));
  for (const char* name : {"TEXCOORD_2", "TANGENT", "_TEMPERATURE"})
    EXPECT_THAT(scene.warnings, Contains(HasSubstr(std::string(name) + " is ignored")));
}

TEST(GltfPrimitive, QuantizedVerticesCountAsTheyAre) {
  GltfBuilder built;
  built.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto positions = [&](int accessor) {
    return built_with(built, {{"attributes", {{"POSITION", accessor}}}}).load().meshes[0].positions;
  };
  EXPECT_THAT(positions(built.accessor<std::int16_t>({0, 0, 0, 300, 0, 0, 0, -7, 0}, "VEC3")),
              ElementsAre(Vec3(0), Vec3(300, 0, 0), Vec3(0, -7, 0)));
  EXPECT_THAT(positions(built.accessor<std::int8_t>({0, 0, 0, 127, 0, 0, 0, -128, 0}, "VEC3", true)),
              ElementsAre(Vec3(0), Vec3(1, 0, 0), Vec3(0, -1, 0)));
}

TEST(GltfAccessor, SparseElementsStandInPlaceOfDenseOnes) {
  GltfBuilder built;
  const int square = built.square();
  const int places = built.view(GltfBuilder::bytes_of<std::uint16_t>({1, 3})),
            values = built.view(GltfBuilder::bytes_of<float>({5, 0, 0, 0, 6, 0}));
  built.json["accessors"][0]["sparse"] = {{"count", 2},
                                          {"indices", {{"bufferView", places}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", values}}}};
  const Json primitive = {{"attributes", {{"POSITION", square}}}, {"mode", 6}};
  EXPECT_THAT(built_with(built, primitive).load().meshes[0].positions,
              ElementsAre(Vec3(0), Vec3(5, 0, 0), Vec3(1, 1, 0), Vec3(0, 6, 0)));
  built.json["accessors"][0].erase("bufferView");  // what is not given is 0
  EXPECT_THAT(built_with(built, primitive).load().meshes[0].positions,
              ElementsAre(Vec3(0), Vec3(5, 0, 0), Vec3(0), Vec3(0, 6, 0)));
  const auto refused_with = [&](const char* pointer, const Json& value) {
    GltfBuilder broken = built;
    broken.json["accessors"][0]["sparse"][Json::json_pointer(pointer)] = value;
    return built_with(broken, primitive).refused();
  };
  EXPECT_THAT(refused_with("/count", 5), HasSubstr("accessors/0/sparse: has 5 elements; accepted: 1 to 4"));
  EXPECT_THAT(refused_with("/count", -1), HasSubstr("accessors/0/sparse: has -1 elements"));
  EXPECT_THAT(refused_with("/count", 3), HasSubstr("its 3 elements reach beyond the buffer view"));
  EXPECT_THAT(refused_with("/values/byteOffset", -4), HasSubstr("negative byteOffset"));
  EXPECT_THAT(refused_with("/indices/bufferView", values), HasSubstr("uses vertex"));
}

TEST(GltfAccessor, AbsurdCountsAreRefusedBeforeAnythingIsMade) {
  GltfBuilder built;
  built.json["accessors"] = {{{"componentType", 5126}, {"count", 4'000'000'000u}, {"type", "VEC3"}}};
  EXPECT_THAT(built_with(built, {{"attributes", {{"POSITION", 0}}}}).refused(),
              HasSubstr("there are 4000000000 vertices; accepted: at most"));
}

TEST(GltfNode, EveryUseOfAMeshIsAnInstanceOfTheSameOne) {
  GltfBuilder built;
  const int mesh = built.triangle_mesh();
  built.json["meshes"][0]["primitives"].push_back(built.json["meshes"][0]["primitives"][0]);
  for (const char* name : {"left", "right"}) built.add("nodes", {{"name", name}, {"mesh", mesh}});
  const Scene scene = built.load();
  EXPECT_EQ(scene.meshes.size(), 2u) << "one a primitive";
  ASSERT_EQ(scene.instances.size(), 4u);
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[1].name, "right");
  EXPECT_EQ(scene.objects[1].track, -1);
  EXPECT_EQ(scene.instances[1].object, 0);
  EXPECT_EQ(scene.instances[2].object, 1);
}

TEST(GltfNode, GpuInstancesStandInTheFrameOfTheirNode) {
  GltfBuilder built;
  built.json["extensionsRequired"] = {"EXT_mesh_gpu_instancing"};
  const int mesh = built.triangle_mesh(), moves = built.accessor<float>({1, 0, 0, 0, 2, 0}, "VEC3"),
            scales = built.accessor<float>({1, 1, 1, 3, 3, 3}, "VEC3");
  const Json attributes = {{"TRANSLATION", moves}, {"SCALE", scales}};
  built.json["nodes"] = {{{"mesh", mesh},
                          {"translation", {10, 0, 0}},
                          {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", attributes}}}}}}};
  const Scene scene = built.load();
  EXPECT_EQ(scene.meshes.size(), 1u);
  EXPECT_EQ(scene.objects.size(), 1u);
  ASSERT_EQ(scene.instances.size(), 2u);
  EXPECT_EQ(Vec3(1, 0, 0) * scene.instances[0].to_world, Vec3(12, 0, 0));
  EXPECT_EQ(Vec3(1, 0, 0) * scene.instances[1].to_world, Vec3(13, 2, 0));
  built.json["nodes"][0]["extensions"]["EXT_mesh_gpu_instancing"]["attributes"]["SCALE"] =
      built.accessor<float>({1, 1, 1}, "VEC3");
  EXPECT_THAT(built.refused(), HasSubstr("nodes/0: instance attributes have 1 and 2 elements"));
}

TEST(GltfNode, MoreThanTheLimitsIsRefused) {
  GltfBuilder built;
  const int mesh = built.triangle_mesh();
  built.json["nodes"] = {{{"children", {1}}}, {{"children", {2}}}, {{"mesh", mesh}}, {{"mesh", mesh}}};
  const auto refused_with = [&](std::uint64_t ImportLimits::*limit, std::uint64_t value) -> std::string {
    const Folder folder;
    ImportLimits limits;
    limits.*limit = value;
    try {
      load_scene(folder.write("built.glb", built.bytes()), limits);
      return "loaded";
    } catch (const InputError& e) {
      return e.what();
    }
  };
  EXPECT_THAT(refused_with(&ImportLimits::instances, 1),
              HasSubstr("there are 2 instances; accepted: at most 1"));
  EXPECT_THAT(refused_with(&ImportLimits::instances, 2), "loaded");
  EXPECT_THAT(refused_with(&ImportLimits::vertices, 2),
              HasSubstr("there are 3 vertices; accepted: at most 2"));
  EXPECT_THAT(refused_with(&ImportLimits::triangles, 0),
              HasSubstr("there are 1 triangles; accepted: at most 0"));
  EXPECT_THAT(refused_with(&ImportLimits::node_depth, 1),
              HasSubstr("nodes/2: there are 2 parents above a node"));
  EXPECT_THAT(refused_with(&ImportLimits::node_depth, 2), "loaded");
  EXPECT_THAT(refused_with(&ImportLimits::file_bytes, 100), HasSubstr("bytes; accepted: at most 100"));
}

TEST(GltfCamera, MayBeOrthographic) {
  GltfBuilder built;
  built.json["cameras"] = {
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 10}}}}};
  built.json["nodes"] = {{{"name", "plan"}, {"camera", 0}, {"translation", {0, 5, 0}}}};
  const Scene scene = built.load();
  EXPECT_EQ(scene.cameras[0].projection, Camera::Projection::orthographic);
  EXPECT_EQ(scene.cameras[0].name, "plan");
  EXPECT_EQ(scene.cameras[0].height, 4) << "ymag is half of it";
  EXPECT_EQ(scene.cameras[0].to_world.translation(), Vec3(0, 5, 0));
  built.json["cameras"][0]["orthographic"]["ymag"] = -2;
  EXPECT_THAT(built.refused(), HasSubstr("cameras/0: ymag is -2; accepted: metres above 0"));
}

TEST(GltfFile, BuffersThatAreNotWholeAreRefused) {
  GltfBuilder built;
  built.json["nodes"] = {{{"mesh", built.triangle_mesh()}}};
  const auto refused_with = [&](const Json& buffers) {
    GltfBuilder broken = built;
    broken.json["buffers"] = buffers;
    return broken.refused();
  };
  EXPECT_THAT(refused_with({{{"byteLength", 37}}}), HasSubstr("buffers/0: has 36 bytes; accepted: 37"));
  EXPECT_THAT(refused_with({{{"byteLength", -1}}}), HasSubstr("buffers/0: the key 'byteLength' is missing"));
  EXPECT_THAT(refused_with({{{"byteLength", 36}, {"uri", "none.bin"}}}), HasSubstr("none.bin: no such file"));
  EXPECT_THAT(refused_with({{{"byteLength", 36}, {"uri", "data:application/octet-stream;base64,AAAA"}}}),
              HasSubstr("buffers/0: has 3 bytes; accepted: 36"));
  EXPECT_THAT(refused_with(Json::array()), HasSubstr("there is no buffer 0"));
  const Folder folder;
  const std::string whole = built.bytes();
  EXPECT_THAT(refusal(folder.write("cut.glb", whole.substr(0, whole.size() - 4))),
              "cut.glb: the binary chunk is cut short; accepted: binary glTF 2.0");
  EXPECT_THAT(refusal(folder.write("cut.glb", whole.substr(0, 30))),
              HasSubstr("the JSON chunk is cut short"));
  EXPECT_THAT(refusal(folder.write("cut.glb", whole.substr(0, 10))), HasSubstr("the file is cut short"));
}

TEST(GltfFile, BuffersAndImagesMayBeFilesWithEscapedNames) {
  GltfBuilder built;
  built.json["nodes"] = {{{"mesh", built.triangle_mesh()}}};
  built.json["buffers"] = {{{"byteLength", built.binary.size()}, {"uri", "a%20b.bin"}}};
  const Folder folder;
  folder.write("a b.bin", built.binary + "more");
  const Scene scene = load_scene(folder.write("built.gltf", built.json.dump()));
  EXPECT_EQ(scene.meshes[0].positions[1], Vec3(1, 0, 0));
}

}  // namespace
}  // namespace tessera
