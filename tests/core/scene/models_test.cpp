// SPDX-License-Identifier: Apache-2.0
// Known values from FBX and PLY files, and from the materials of OBJ.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/core/scene/models.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::SizeIs;
using testing::StartsWith;
using Triangle = std::array<std::uint32_t, 3>;

const Material& material_named(const Scene& scene, std::string_view name) {
  for (const Material& m : scene.materials)
    if (m.name == name) return m;
  throw std::out_of_range(std::string(name));
}

class ObjMaterial : public testing::Test {
 protected:
  // The material that a library of these statements gives.
  Material with(const std::string& statements) {
    folder_.write("m.mtl", "newmtl m\n" + statements);
    scene_ = load_scene(
        folder_.write("m.obj", "mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n"));
    return material_named(scene_, "m");
  }
  const Folder folder_;
  Scene scene_;
};

TEST_F(ObjMaterial, IsDiffuseIfNothingElseIsSaid) {
  const Material m = with("Kd 0.5 0.25 1\n");
  EXPECT_EQ(m.kind, Material::Kind::diffuse);
  EXPECT_EQ(m.base_color, Color(0.5f, 0.25f, 1));
  EXPECT_EQ(m.alpha, Material::Alpha::opaque);
}

TEST_F(ObjMaterial, WithAHighlightIsPlastic) {
  const Material m = with("Kd 0.5 0.5 0.5\nKs 0.5 0.5 0.5\nNs 30\nNi 1.25\nillum 2\n");
  EXPECT_EQ(m.kind, Material::Kind::plastic);
  EXPECT_EQ(m.roughness, 0.5f) << "alpha = sqrt(2 / (30 + 2)) = 1/4, roughness its root";
  EXPECT_EQ(m.ior, 1.25f);
}

TEST_F(ObjMaterial, WithoutAHighlightInItsModelLosesKsInWords) {
  EXPECT_EQ(with("Ks 0.5 0.5 0.5\nNs 30\nillum 1\n").kind, Material::Kind::diffuse);
  EXPECT_THAT(scene_.warnings,
              Contains(HasSubstr("material 'm': Ks is ignored: with illum 1 it is diffuse")));
}

TEST_F(ObjMaterial, OfModelFiveIsAMirrorAndOfSevenGlass) {
  const Material mirror = with("Kd 0 0 0\nKs 0.9 0.8 0.7\nillum 5\n");
  EXPECT_EQ(mirror.kind, Material::Kind::mirror);
  EXPECT_EQ(mirror.base_color, Color(0.9f, 0.8f, 0.7f));
  const Material glass = with("Ni 1.33\nTf 0.9 1 0.9\nd 0.2\nillum 7\n");
  EXPECT_EQ(glass.kind, Material::Kind::glass);
  EXPECT_EQ(glass.ior, 1.33f);
  EXPECT_EQ(glass.roughness, 0);
  EXPECT_EQ(glass.base_color, Color(0.9f, 1, 0.9f));
  EXPECT_EQ(glass.alpha, Material::Alpha::opaque) << "it is clear, not a hole";
}

TEST_F(ObjMaterial, OpacityIsBlended) {
  for (const char* opacity : {"d 0.25\n", "Tr 0.75\n"}) {
    const Material m = with(opacity);
    EXPECT_EQ(m.alpha, Material::Alpha::blend);
    EXPECT_EQ(m.base_alpha, 0.25f);
  }
}

TEST_F(ObjMaterial, WithPrOrPmIsMetallicRoughness) {
  const Material m = with("Kd 1 0.5 0\nPr 0.25\nPm 0.75\nillum 2\n");
  EXPECT_EQ(m.kind, Material::Kind::metallic_roughness);
  EXPECT_EQ(m.roughness, 0.25f);
  EXPECT_EQ(m.metallic, 0.75f);
}

TEST_F(ObjMaterial, TransparencyOfThePictureItselfIsReadAndOfAnotherNot) {
  folder_.write("a.png", contents(kData / "corners.png"));
  folder_.write("b.png", contents(kData / "corners.png"));
  EXPECT_EQ(with("map_Kd a.png\nmap_d a.png\n").alpha, Material::Alpha::blend);
  EXPECT_EQ(with("map_Kd a.png\nmap_d b.png\n").alpha, Material::Alpha::opaque);
  EXPECT_THAT(scene_.warnings, Contains(HasSubstr("the opacity map is ignored")));
}

TEST_F(ObjMaterial, BumpMapsAreLeftOutInWords) {
  with("map_Bump -bm 0.5 bumps.png\n");
  EXPECT_THAT(scene_.warnings, Contains(HasSubstr("'map_Bump -bm 0.5 bumps.png' is left out")));
}

TEST(Ply, TextHasVerticesColoursAndPolygons) {
  const Folder folder;
  const Scene scene = load_scene(folder.write("square.ply", kTextPly));
  ASSERT_THAT(scene.meshes, SizeIs(1));
  EXPECT_THAT(scene.meshes[0].triangles, SizeIs(2));
  ASSERT_THAT(scene.meshes[0].positions, SizeIs(4));
  for (std::size_t v = 0; v < 4; ++v) {
    const Vec3 p = scene.meshes[0].positions[v];
    const auto& c = scene.meshes[0].colors.at(v);
    EXPECT_NEAR(c[0], p.x, 1e-6) << "red where x is 1";
    EXPECT_NEAR(c[1], p.y > 0 ? std::pow((188.0 / 255 + 0.055) / 1.055, 2.4) : 0, 1e-6)
        << "decoded from sRGB";
  }
  EXPECT_EQ(scene.materials[0].base_color, Color(1)) << "the colours alone count";
}

TEST(Ply, BinaryIsTheSameAsText) {
  const Folder folder;
  const Scene text = load_scene(folder.write("a.ply", kTextPly)),
              binary = load_scene(folder.write("b.ply", binary_ply()));
  ASSERT_THAT(binary.meshes, SizeIs(1));
  EXPECT_EQ(binary.meshes[0].positions, text.meshes[0].positions);
  EXPECT_EQ(binary.meshes[0].triangles, text.meshes[0].triangles);
  EXPECT_EQ(binary.meshes[0].colors, text.meshes[0].colors);
}

TEST(Ply, BigEndianNormalsCoordinatesAndPicturesAreRead) {
  std::string ply =
      "ply\nformat binary_big_endian 1.0\ncomment TextureFile corners.png\nelement face 1\n"
      "property list uchar uint vertex_index\nelement vertex 3\nproperty float x\nproperty float y\n"
      "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nproperty double s\n"
      "property double t\nelement edge 1\nproperty short v\nend_header\n";
  const auto append = [&](auto value) {
    std::string bytes;
    append_bytes(bytes, value);
    ply.append(bytes.rbegin(), bytes.rend());
  };
  ply += '\3';
  for (const std::uint32_t v : {0u, 1u, 2u}) append(v);
  for (int v = 0; v < 3; ++v) {
    for (const float f : {v == 1 ? 1.0f : 0.0f, v == 2 ? 1.0f : 0.0f, 0.0f, 0.0f, 0.0f, 1.0f}) append(f);
    append(0.25), append(1.0);
  }
  append(std::int16_t{7});
  const Folder folder;
  folder.write("corners.png", contents(kData / "corners.png"));
  const Scene scene = load_scene(folder.write("big.ply", ply));
  EXPECT_THAT(scene.meshes.at(0).positions, ElementsAre(Vec3(0), Vec3(1, 0, 0), Vec3(0, 1, 0)));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_EQ(scene.meshes[0].normals.at(2), Vec3(0, 0, 1));
  EXPECT_EQ(scene.meshes[0].uvs.at(0), Vec2(0.25f, 0)) << "v points up in PLY";
  EXPECT_TRUE(scene.materials[0].base_color_texture);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("the element 'edge' is left out")));
}

TEST(Ply, BrokenOnesAreRefusedByName) {
  const Folder folder;
  const auto refused = [&](std::string text, const std::string& from, const std::string& to) {
    return refusal(folder.write("bad.ply", text.replace(text.find(from), from.size(), to)));
  };
  EXPECT_THAT(refused(kTextPly, "vertex 4", "vertex 4000000000"),
              StartsWith("bad.ply: the header promises 4000000000 of 'vertex'"));
  EXPECT_THAT(refused(kTextPly, "vertex 4", "vertex -4"),
              StartsWith("bad.ply: the header promises '-4' of 'vertex'"));
  EXPECT_THAT(refused(kTextPly, "end_header", "end_of_it"), HasSubstr("the header has no end"));
  EXPECT_THAT(refused(kTextPly, "ply", "solid"),
              HasSubstr("does not begin with 'ply'; accepted: Stanford PLY"));
  EXPECT_THAT(refused(kTextPly, "4 0 1 2 3", "4 0 1 2 9"), HasSubstr("a face uses vertex 9 of 4"));
  EXPECT_THAT(refused(kTextPly, "4 0 1 2 3", "4 0 1 2 -3"), HasSubstr("a face uses vertex -3"));
  EXPECT_THAT(refused(kTextPly, "4 0 1 2 3", "4 0 1"), HasSubstr("the file is cut short"));
  EXPECT_THAT(refused(kTextPly, "4 0 1 2 3", "-4 0 1 2 3"),
              HasSubstr("a list 'vertex_indices' of -4 numbers"));
  EXPECT_THAT(refused(kTextPly, "1 1 0 255", "1 x 0 255"), HasSubstr("'x' is no number"));
  EXPECT_THAT(refused(kTextPly, "uchar red", "bool red"), HasSubstr("has the unknown type 'bool'"));
  EXPECT_THAT(refused(kTextPly, "ascii", "gzip"), HasSubstr("has the unknown format 'gzip'"));
  const std::string binary = binary_ply();
  EXPECT_THAT(refusal(folder.write("bad.ply", binary.substr(0, binary.size() - 1))),
              HasSubstr("the file is cut short"));
}

class Fbx : public testing::Test {
 protected:
  const Folder folder_;
};

TEST_F(Fbx, TextIsTurnedAndScaledAsItSays) {
  const Scene scene = load_scene(folder_.write("card.fbx", kTextFbx));
  EXPECT_THAT(scene.meshes, SizeIs(1));
  EXPECT_THAT(scene.meshes[0].triangles, SizeIs(2));
  ASSERT_THAT(scene.instances, SizeIs(2)) << "two models of one geometry";
  EXPECT_EQ(scene.objects[0].name, "panel");
  EXPECT_EQ(scene.objects[1].name, "again");
  // Decimetres, +Z up: (10, 0, 20) is 1 m to the right and 2 m up; the first stands 100 to the right, the
  // second is twice as large.
  EXPECT_TRUE((Vec3(10, 0, 20) * scene.instances[0].to_world).equalWithAbsError({11, 2, 0}, 1e-5f));
  EXPECT_TRUE((Vec3(10, 0, 20) * scene.instances[1].to_world).equalWithAbsError({2, 4, 0}, 1e-5f));
}

TEST_F(Fbx, MaterialsLightsAndCamerasAreRead) {
  const Scene scene = load_scene(folder_.write("card.fbx", kTextFbx));
  const Material& m = material_named(scene, "red");
  EXPECT_EQ(m.kind, Material::Kind::plastic);
  EXPECT_EQ(m.roughness, 0.5f) << "exponent 30";
  EXPECT_EQ(m.base_color, Color(0.5f, 0.25f, 1));
  EXPECT_EQ(m.emission, Color(0, 2, 0));
  EXPECT_EQ(m.alpha, Material::Alpha::blend);
  EXPECT_EQ(m.base_alpha, 0.5f);
  ASSERT_THAT(scene.points, SizeIs(1));
  EXPECT_TRUE(scene.points[0].position.equalWithAbsError({0, 5, 0}, 1e-5f));
  EXPECT_EQ(scene.points[0].intensity, Color(4, 2, 1)) << "per cent of its colour";
  ASSERT_THAT(scene.cameras, SizeIs(1));
  EXPECT_EQ(scene.cameras[0].name, "eye");
  EXPECT_NEAR(scene.cameras[0].horizontal_fov, 1.0471976, 1e-6);
  EXPECT_TRUE(scene.cameras[0].to_world.translation().equalWithAbsError({0, 0, 3}, 1e-5f));
  Vec3 view;
  scene.cameras[0].to_world.multDirMatrix(Vec3(0, 0, -1), view);
  EXPECT_TRUE(view.equalWithAbsError({1, 0, 0}, 1e-5f)) << "an FBX camera looks along its +X";
}

TEST_F(Fbx, BinaryIsReadAndItsEmbeddedPicturesToo) {
  const Scene scene = load_scene(folder_.write("card.fbx", binary_fbx()));
  ASSERT_THAT(scene.meshes, SizeIs(1));
  EXPECT_THAT(scene.meshes[0].triangles, ElementsAre(Triangle{0, 1, 2}));
  ASSERT_THAT(scene.pictures, SizeIs(1));
  EXPECT_EQ(scene.pictures[0].width, 2);
  EXPECT_THAT(scene.pictures[0].name, HasSubstr("card.fbx#"));
}

TEST_F(Fbx, BrokenOnesAreRefusedByName) {
  const std::string good = binary_fbx();
  const auto refused = [&](const std::string& bytes) { return refusal(folder_.write("bad.fbx", bytes)); };
  EXPECT_THAT(refused(good.substr(0, 20)), StartsWith("bad.fbx: "));
  EXPECT_THAT(refused(good.substr(0, 200)), AllOf(StartsWith("bad.fbx: "), HasSubstr("reaches out of")));
  EXPECT_THAT(refused("no FBX at all"), StartsWith("bad.fbx: "));
  std::string deep = "FBXHeaderExtension: {\n";
  for (int i = 0; i < 100'000; ++i) deep += "a: {\n";
  EXPECT_THAT(refused(deep), HasSubstr("braces are nested deeper than 64"));
  const auto changed = [](const std::string& from, const std::string& to) {
    std::string text = kTextFbx;
    return text.replace(text.find(from), from.size(), to);
  };
  EXPECT_THAT(refused(changed("C: \"OO\",20,0", "C: \"OO\",20,20")), HasSubstr("an object is below itself"));
  EXPECT_THAT(refused(changed("C: \"OO\",20,0", "C:\n\"OO\" , 20,;\n10\n")),
              HasSubstr("an object is below itself"));
  EXPECT_THAT(refused(changed("Layer: 0 {", "Layer: {")), HasSubstr("a Layer has no number"));
  std::string chain;
  for (int i = 1000; i < 3000; ++i) chain += fmt::format("C: \"OO\",{},{}\n", i, i + 1);
  EXPECT_THAT(refused(changed("C: \"OO\",20,0", chain)),
              HasSubstr("an object is below more than 1000 others"));
  std::string circle = good;  // the connection of the model to the root, made one to itself
  const auto edge = circle.find(std::string("OOL\x14\0\0\0\0\0\0\0L\0", 13));
  ASSERT_NE(edge, std::string::npos);
  circle[edge + 12] = '\x14';
  EXPECT_THAT(refused(circle), HasSubstr("an object is below itself"));
  std::string huge = good;  // an array of doubles that says it has 2^31 of them
  const auto at = huge.find("Vertices") + 8;
  huge.replace(at + 1, 4, std::string("\0\0\0\x80", 4));
  EXPECT_THAT(refused(huge), HasSubstr("cannot have 17179869184 bytes; accepted: binary FBX"));
  std::string long_property = good;  // a property list longer than its record
  long_property[27 + 8] = '\x7f';
  EXPECT_THAT(refused(long_property), StartsWith("bad.fbx: "));
}

}  // namespace
}  // namespace tessera
