// SPDX-License-Identifier: Apache-2.0
// Every key of full.json ends in the member of Scene that it speaks of.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::FloatNear;
using testing::Pointwise;
constexpr float kPiF = std::numbers::pi_v<float>;
constexpr float kClose = 1e-6f;

class FullScene : public testing::Test {
 protected:
  const Material& material(std::string_view name) const {
    for (const Material& m : scene_.materials)
      if (m.name == name) return m;
    throw std::out_of_range(std::string(name));
  }
  const Object& object(int index) const { return scene_.objects.at(static_cast<std::size_t>(index)); }
  int object_named(std::string_view name) const {
    for (std::size_t o = 0; o < scene_.objects.size(); ++o)
      if (scene_.objects[o].name == name) return static_cast<int>(o);
    return -1;
  }
  const Mesh& mesh(std::string_view name) const {
    for (const Mesh& m : scene_.meshes)
      if (m.name == name) return m;
    throw std::out_of_range(std::string(name));
  }
  const Scene scene_ = load_scene(kData / "full.json");
};

TEST_F(FullScene, TheCameraHasALensAShutterAndAFocus) {
  const Camera& c = scene_.cameras[0];
  EXPECT_EQ(c.projection, Camera::Projection::perspective);
  EXPECT_FLOAT_EQ(c.vertical_fov, 2 * std::atan(12.0f / 50)) << "of a picture 24 mm high";
  EXPECT_FLOAT_EQ(c.lens_radius, 0.050f / (2 * 2)) << "focal length over twice the f-number, in metres";
  EXPECT_EQ(c.blades, 6);
  EXPECT_FLOAT_EQ(c.blade_rotation, 15 * kPiF / 180);
  EXPECT_TRUE(c.autofocus);
  EXPECT_EQ(c.shutter_open, -0.25f);
  EXPECT_EQ(c.shutter_close, 0.25f);
  EXPECT_EQ(c.track, -1);
}

TEST_F(FullScene, CamerasAreAlsoOrthographicAndPanoramic) {
  const Camera &plan = scene_.cameras[1], &around = scene_.cameras[2];
  EXPECT_EQ(plan.projection, Camera::Projection::orthographic);
  EXPECT_EQ(plan.width, 12);
  EXPECT_EQ(plan.lens_radius, 0.5f);
  EXPECT_FLOAT_EQ(plan.focus_distance, 9);
  EXPECT_FALSE(plan.autofocus);
  EXPECT_EQ(around.projection, Camera::Projection::panorama);
  EXPECT_EQ(around.to_world.translation(), Vec3(0, 1, 0));
}

TEST_F(FullScene, ACameraMovesByItsKeys) {
  const Camera& ride = scene_.cameras[3];
  EXPECT_FLOAT_EQ(ride.lens_radius, 0.018f / std::tan(kPiF / 6) / 8) << "a picture 36 mm wide, f/4";
  EXPECT_FLOAT_EQ(ride.focus_distance, 3);
  EXPECT_EQ(ride.to_world, Matrix());
  const Track& track = scene_.tracks.at(static_cast<std::size_t>(ride.track));
  EXPECT_THAT(track.times, ElementsAre(0, 0.5f));
  EXPECT_EQ(track.poses[0].translation(), Vec3(0, 0, 3));
  EXPECT_TRUE((Vec3(0, 0, -1) * track.poses[1]).equalWithAbsError({0, 0, 3}, kClose)) << "it looks to -X now";
}

TEST_F(FullScene, LightsHaveGroupsAndFactors) {
  EXPECT_THAT(scene_.light_groups, ElementsAre("key", "fill"));
  EXPECT_EQ(scene_.points[0].light, (LightTraits{0, 0.5f, 0}));
  EXPECT_EQ(scene_.spots[0].light, (LightTraits{1, 1, 1}));
  EXPECT_NEAR(scene_.spots[0].direction.length(), 1, kClose);
  EXPECT_EQ(scene_.suns[0].light, (LightTraits{-1, 1, 2}));
  EXPECT_FALSE(scene_.suns[0].camera);
  EXPECT_EQ(scene_.environment.light, (LightTraits{1, 0.25f, 1}));
  EXPECT_FLOAT_EQ(scene_.environment.rotation, -77 * kPiF / 180);
  EXPECT_EQ(scene_.environment.radiance, Color(1, 0.5f, 0.25f));
  EXPECT_EQ(scene_.background.kind, Background::Kind::color);
  EXPECT_EQ(scene_.background.color, Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(scene_.frames_per_second, 25);
}

TEST_F(FullScene, MaterialsOfEveryKind) {
  EXPECT_EQ(material("paper").kind, Material::Kind::translucent);
  EXPECT_EQ(material("paper").transmission_color, Color(0.5f, 0.6f, 0.7f));
  EXPECT_EQ(material("toy").kind, Material::Kind::plastic);
  EXPECT_EQ(material("toy").ior, 1.4f);
  EXPECT_EQ(material("toy").roughness, 0) << "plastic shines unless it is told not to";
  EXPECT_EQ(material("ring").kind, Material::Kind::metal) << "a metal's name makes a metal";
  EXPECT_EQ(material("ring").eta, Color(0.188f, 0.544f, 1.332f));
  EXPECT_EQ(material("ring").k, Color(3.403f, 2.231f, 1.869f));
  EXPECT_EQ(material("ball").exponent, 500);
  EXPECT_EQ(material("sign").kind, Material::Kind::unlit);
  EXPECT_EQ(material("sign").alpha, Material::Alpha::blend);
  EXPECT_TRUE(material("pane").thin);
  EXPECT_EQ(material("pane").roughness, 0) << "glass is smooth unless it is told not to be";
  EXPECT_EQ(material("juice").roughness, 0.2f);
  EXPECT_EQ(material("juice").attenuation_color, Color(0.9f, 0.5f, 0.1f));
  EXPECT_EQ(material("juice").attenuation_distance, 0.05f);
  EXPECT_FALSE(material("lamp").double_sided);
}

TEST_F(FullScene, AMixNamesWhatItMixes) {
  const Material& blend = material("blend");
  EXPECT_EQ(blend.kind, Material::Kind::mix);
  EXPECT_EQ(&scene_.materials[static_cast<std::size_t>(blend.first)], &material("toy"));
  EXPECT_EQ(&scene_.materials[static_cast<std::size_t>(blend.second)], &material("ring"));
  EXPECT_EQ(blend.mix, 0.25f);
  EXPECT_TRUE(blend.mix_texture);
  EXPECT_EQ(blend.mix_texture.uv_set, 1);
}

TEST_F(FullScene, LayersOfMetallicRoughness) {
  const Material& m = material("coat");
  EXPECT_EQ(m.transmission, 0.25f);
  EXPECT_EQ(m.clearcoat, 0.75f);
  EXPECT_EQ(m.clearcoat_roughness, 0.125f);
  EXPECT_EQ(m.clearcoat_normal_scale, 2);
  EXPECT_EQ(m.sheen_color, Color(0.1f, 0.2f, 0.3f));
  EXPECT_EQ(m.sheen_roughness, 0.5f);
  for (const Texture* t : {&m.transmission_texture, &m.clearcoat_texture, &m.clearcoat_roughness_texture,
                           &m.clearcoat_normal_texture, &m.sheen_color_texture, &m.sheen_roughness_texture})
    EXPECT_TRUE(*t);
  EXPECT_NE(m.sheen_color_texture.picture, m.clearcoat_texture.picture) << "sRGB and linear are two pictures";
}

TEST_F(FullScene, TexturesAreScaledThenTurnedThenMoved) {
  const Texture& color = material("coat").base_color_texture;
  EXPECT_EQ(color.uv_set, 1);
  EXPECT_EQ(color.wrap_u, Texture::Wrap::mirror);
  EXPECT_EQ(color.wrap_v, Texture::Wrap::mirror);
  // KHR_texture_transform at 90 degrees, v down: (1, 0) goes up, to (0, -1), and (0, 1) to (1, 0).
  const std::array<float, 6> expected{0, 4, 0.5f, -2, 0, 0.25f};
  EXPECT_THAT(color.transform, Pointwise(FloatNear(kClose), expected));
  EXPECT_THAT(material("coat").normal_texture.transform, ElementsAre(1, 2, 3, 4, 5, 6));
  EXPECT_EQ(material("coat").normal_texture.wrap_u, Texture::Wrap::repeat);
  EXPECT_EQ(material("coat").normal_texture.wrap_v, Texture::Wrap::clamp);
}

TEST_F(FullScene, ObjectsSayWhatSeesThem) {
  const Object& hidden = object(scene_.spheres[0].object);
  EXPECT_FALSE(hidden.camera || hidden.scattered || hidden.shadow);
  const Object& lamp = object(scene_.quads[0].object);
  EXPECT_EQ(lamp.name, "the lamp");
  EXPECT_EQ(lamp.light, (LightTraits{0, 0.75f, 0.5f}));
  EXPECT_TRUE(lamp.camera && lamp.scattered && lamp.shadow && !lamp.catcher);
  EXPECT_EQ(scene_.disks[0].object, -1);
}

TEST_F(FullScene, AnObjectsMaterialIsThatOfItsParts) {
  EXPECT_TRUE(object(object_named("ground")).catcher);
  EXPECT_EQ(&scene_.materials[static_cast<std::size_t>(mesh("floor").material)], &material("paper"));
}

TEST_F(FullScene, AnObjectMovesByItsKeysOnTopOfWhereItStands) {
  const int wheel = object_named("wheel");
  const Track& track = scene_.tracks.at(static_cast<std::size_t>(object(wheel).track));
  EXPECT_THAT(track.times, ElementsAre(-1, 0, 2.5f));
  EXPECT_EQ(track.poses[0], Matrix());
  EXPECT_TRUE((Vec3(1, 0, 0) * track.poses[1]).equalWithAbsError({1, 4, 3}, kClose));
  EXPECT_EQ(track.poses[2].translation(), Vec3(7, 8, 9));
  const Instance* moving = nullptr;
  for (const Instance& i : scene_.instances)
    if (i.object == wheel) moving = &i;
  ASSERT_NE(moving, nullptr);
  EXPECT_EQ(moving->to_world.translation(), Vec3(-0.1f, 0.2f, 0));
}

TEST_F(FullScene, MeshesHaveColoursAndASecondSetOfCoordinates) {
  const Mesh& floor = mesh("floor");
  EXPECT_EQ(floor.uvs2[1], Vec2(2, 2));
  EXPECT_THAT(floor.colors[0], ElementsAre(1, 0, 0, 1));
  EXPECT_THAT(floor.colors[3], ElementsAre(0.5f, 0.5f, 0.5f, 0.25f));
  for (const Instance& i : scene_.instances)
    EXPECT_NE(scene_.meshes[static_cast<std::size_t>(i.mesh)].name, "spare") << "it is not placed";
}

TEST_F(FullScene, ShapesThatAreLights) {
  const Quad& q = scene_.quads[0];
  EXPECT_EQ(q.corner, Vec3(-1, 3, -1));
  EXPECT_EQ(q.edge_u, Vec3(2, 0, 0));
  EXPECT_EQ(q.edge_v, Vec3(0, 0, 2));
  EXPECT_EQ(scene_.materials[static_cast<std::size_t>(q.material)].emission, Color(5, 4, 3));
  const Disk& d = scene_.disks[0];
  EXPECT_EQ(d.center, Vec3(0, 2, 0));
  EXPECT_EQ(d.normal, Vec3(0, -1, 0));
  EXPECT_EQ(d.radius, 0.25f);
}

TEST_F(FullScene, VariantsChooseMaterialsForMeshes) {
  ASSERT_EQ(scene_.variants.size(), 2u);
  EXPECT_EQ(scene_.variants[0].name, "red");
  ASSERT_EQ(scene_.variants[0].choices.size(), 2u);
  const auto [mesh_index, material_index] = scene_.variants[0].choices[1];
  EXPECT_EQ(scene_.meshes[static_cast<std::size_t>(mesh_index)].name, "blade");
  EXPECT_EQ(scene_.materials[static_cast<std::size_t>(material_index)].name, "ring");
}

TEST(NativeImport, BecomesOneObjectThatMovesWithItsCameras) {
  const Folder folder;
  folder.write("part.json",
               R"({"objects": {"inner": {}}, "camera": {"matrix": [1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]},
    "meshes": {"m": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "object": "inner"}}})");
  const Scene scene = load_scene(folder.write("s.json", R"({
    "import": [{"file": "part.json", "object": "car", "transform": {"translate": [1, 0, 0]}}],
    "objects": {"car": {"visibility": {"camera": false}, "keys": [{"time": 0}, {"time": 1, "translate": [0, 0, 9]}]}}})"));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "car");
  EXPECT_FALSE(scene.objects[0].camera);
  EXPECT_EQ(scene.instances[0].object, 0);
  EXPECT_EQ(scene.instances[0].to_world.translation(), Vec3(1, 0, 0));
  EXPECT_EQ(scene.cameras[0].track, scene.objects[0].track);
}

TEST(NativeImport, ObjectsOfAFileAreChangedByName) {
  const Folder folder;
  folder.write("part.json", R"({"objects": {"chair": {"shadow_catcher": true}, "table": {}},
    "spheres": [{"center": [0,0,0], "object": "table"}, {"center": [1,0,0], "object": "chair"}]})");
  const Scene scene = load_scene(folder.write("s.json", R"({"import": [{"file": "part.json"}],
    "materials": {"wood": {"color": 0.25}},
    "objects": {"chair": {"visibility": {"shadow": false}, "material": "wood"}}})"));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_FALSE(scene.objects[0].shadow);
  EXPECT_TRUE(scene.objects[0].catcher) << "what is not given stays";
  EXPECT_EQ(scene.materials[static_cast<std::size_t>(scene.spheres[1].material)].name, "wood");
  EXPECT_NE(scene.materials[static_cast<std::size_t>(scene.spheres[0].material)].name, "wood");
}

TEST(NativeImport, AMeshSharedByObjectsIsCopiedForTheOneThatGetsAMaterial) {
  const Folder folder;
  const Scene scene = load_scene(folder.write("s.json", R"({"materials": {"a": {}, "b": {}},
    "objects": {"one": {"material": "b"}, "two": {}},
    "meshes": {"m": {"positions": [[0,0,0],[1,0,0],[0,1,0]], "triangles": [[0,1,2]], "material": "a"}},
    "instances": [{"mesh": "m", "object": "one"}, {"mesh": "m", "object": "two"}]})"));
  ASSERT_EQ(scene.meshes.size(), 2u);
  EXPECT_EQ(scene.meshes[static_cast<std::size_t>(scene.instances[0].mesh)].material, 1);
  EXPECT_EQ(scene.meshes[static_cast<std::size_t>(scene.instances[1].mesh)].material, 0);
}

TEST(NativeImport, EnvironmentBackgroundAndFrameRateOfAFileAreTakenIn) {
  const Folder folder;
  folder.write("part.json", R"({"environment": {"radiance": 2, "group": "sky"}, "background": "transparent",
    "frames_per_second": 30, "spheres": [{"center": [0,0,0]}]})");
  const Scene scene =
      load_scene(folder.write("s.json", R"({"light_groups": ["key"], "import": [{"file": "part.json"}]})"));
  EXPECT_EQ(scene.background.kind, Background::Kind::transparent);
  EXPECT_EQ(scene.frames_per_second, 30);
  EXPECT_THAT(scene.light_groups, ElementsAre("key", "sky"));
  EXPECT_EQ(scene.environment.light.group, 1);
}

}  // namespace
}  // namespace tessera
