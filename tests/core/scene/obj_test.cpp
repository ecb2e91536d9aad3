// SPDX-License-Identifier: Apache-2.0
// Known values from a Wavefront OBJ file.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/mtl.h"
#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::HasSubstr;

const Mesh& mesh_of(const Scene& scene, std::string_view material) {
  for (const Mesh& m : scene.meshes)
    if (scene.materials[static_cast<std::size_t>(m.material)].name == material) return m;
  throw std::out_of_range(std::string(material));
}

TEST(Obj, MeshesHaveTheirVerticesMaterialsAndTrianglesFromQuads) {
  const Scene scene = load_scene(kData / "card.obj");
  const Mesh &paper = mesh_of(scene, "paper"), &lamp = mesh_of(scene, "lamp");
  EXPECT_EQ(paper.triangles.size(), 2u);
  EXPECT_EQ(paper.positions.size(), 4u);
  EXPECT_EQ(lamp.triangles.size(), 2u);
  EXPECT_TRUE(lamp.normals.empty());
  EXPECT_EQ(paper.normals.at(0), Vec3(0, 0, 1));
  for (std::size_t v = 0; v < 4; ++v)
    EXPECT_EQ(paper.uvs[v], Vec2(paper.positions[v].x, 1 - paper.positions[v].y / 2)) << "v points down";
}

TEST(Obj, MaterialsKeepTheirColoursPicturesAndOpacity) {
  const Scene scene = load_scene(kData / "card.obj");
  const Material& paper = scene.materials[static_cast<std::size_t>(mesh_of(scene, "paper").material)];
  const Material& lamp = scene.materials[static_cast<std::size_t>(mesh_of(scene, "lamp").material)];
  EXPECT_EQ(paper.kind, Material::Kind::diffuse);
  EXPECT_EQ(paper.base_color, Color(0.5f, 0.25f, 1));
  EXPECT_TRUE(paper.base_color_texture);
  EXPECT_EQ(lamp.emission, Color(4, 2, 1));
  EXPECT_EQ(lamp.alpha, Material::Alpha::blend);
  EXPECT_EQ(lamp.base_alpha, 0.5f);
}

TEST(Obj, AMissingMaterialLibraryIsSaidAndAMissingTextureRefused) {
  const Folder folder;
  const auto file = folder.write("card.obj", contents(kData / "card.obj"));
  EXPECT_THAT(load_scene(file).warnings, Contains(HasSubstr("there is no material library 'card.mtl'")));
  folder.write("card.mtl", contents(kData / "card.mtl"));
  EXPECT_THAT(refusal(file), HasSubstr("material 'paper': "));
  EXPECT_THAT(refusal(file), HasSubstr("corners.png: no such file"));
}

TEST(CheckedMtl, KeepsWholeStatementsWithinAMaterialAndNamesTheOthers) {
  const CheckedMtl mtl = checked_mtl(
      "Kd 1 1 1\n# c\nnewmtl  a b \nKd .5 0.25 1 junk\nKe 1 2\nKs nan 0 0\nmap_Kd -s 1 1 1 x.png\nmap_Kd y "
      "z.png\r\n");
  EXPECT_EQ(mtl.text, "newmtl a b\nKd 0.5 0.25 1\nmap_Kd y z.png\n");
  EXPECT_THAT(mtl.warnings, testing::ElementsAre(HasSubstr("1: 'Kd 1 1 1'"), HasSubstr("5: 'Ke 1 2'"),
                                                 HasSubstr("6: 'Ks nan"), HasSubstr("7: 'map_Kd -s")));
}

TEST(Obj, AModelWithoutLightIsLitAndSaysSo) {
  const Folder folder;
  const Scene scene = load_scene(folder.write("t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"));
  EXPECT_EQ(scene.environment.radiance, Color(1));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("there is no light")));
}

}  // namespace
}  // namespace tessera
