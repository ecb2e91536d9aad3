// SPDX-License-Identifier: Apache-2.0
// Materials and textures of glTF, with every extension that is understood.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/scene/gltf_builder.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Json = nlohmann::json;

class GltfMaterial : public testing::Test {
 protected:
  GltfMaterial() {
    folder_.write("corners.png", contents(kData / "corners.png"));
    built_.json["images"] = {{{"uri", "corners.png"}}};
    built_.json["textures"] = {{{"source", 0}}};
    built_.json["nodes"] = {{{"mesh", built_.triangle_mesh()}}};
  }
  Scene with(const Json& material) {
    built_.json["materials"] = {material};
    return load_scene(folder_.write("built.glb", built_.bytes()));
  }
  Material material_with(const char* extension, const Json& value) {
    const Scene scene = with({{"extensions", {{extension, value}}}});
    EXPECT_THAT(scene.warnings, Contains(HasSubstr("there is no light"))) << "and no other";
    EXPECT_EQ(scene.warnings.size(), 1u);
    return scene.materials[0];
  }
  const Folder folder_;
  GltfBuilder built_;
};

TEST_F(GltfMaterial, WithoutAnythingIsThatOfTheSpecification) {
  const Material m = with(Json::object()).materials[0];
  EXPECT_EQ(m.kind, Material::Kind::metallic_roughness);
  EXPECT_EQ(m.base_color, Color(1));
  EXPECT_EQ(m.metallic, 1);
  EXPECT_EQ(m.roughness, 1);
  EXPECT_EQ(m.ior, 1.5f);
  EXPECT_EQ(m.alpha, Material::Alpha::opaque);
  EXPECT_FALSE(m.double_sided);
  EXPECT_FALSE(m.thin);
  EXPECT_EQ(m.transmission, 0);
}

TEST_F(GltfMaterial, BlendsByItsAlpha) {
  const Material m =
      with({{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.25}}}}})
          .materials[0];
  EXPECT_EQ(m.alpha, Material::Alpha::blend);
  EXPECT_EQ(m.base_alpha, 0.25f);
}

TEST_F(GltfMaterial, OcclusionIsTracedAndSoNoLoss) {
  EXPECT_EQ(with({{"occlusionTexture", {{"index", 0}}}}).warnings.size(), 1u) << "no light, and no other";
}

TEST_F(GltfMaterial, TransmissionWithoutThicknessIsASheet) {
  const Material m = material_with("KHR_materials_transmission",
                                   {{"transmissionFactor", 0.75}, {"transmissionTexture", {{"index", 0}}}});
  EXPECT_EQ(m.transmission, 0.75f);
  EXPECT_TRUE(m.transmission_texture);
  EXPECT_TRUE(m.thin);
}

TEST_F(GltfMaterial, AVolumeWithThicknessIsASolid) {
  const Json transmission = {{"transmissionFactor", 1}};
  const auto with_thickness = [&](double thickness) {
    return with({{"extensions",
                  {{"KHR_materials_transmission", transmission},
                   {"KHR_materials_volume",
                    {{"thicknessFactor", thickness},
                     {"attenuationColor", {0.5, 0.25, 1}},
                     {"attenuationDistance", 3}}}}}})
        .materials[0];
  };
  EXPECT_TRUE(with_thickness(0).thin);
  const Material solid = with_thickness(0.1);
  EXPECT_FALSE(solid.thin);
  EXPECT_EQ(solid.attenuation_color, Color(0.5f, 0.25f, 1));
  EXPECT_EQ(solid.attenuation_distance, 3);
}

TEST_F(GltfMaterial, AVolumeWithoutADistanceIsClear) {
  EXPECT_EQ(material_with("KHR_materials_volume", {{"thicknessFactor", 1}}).attenuation_distance, 0);
}

TEST_F(GltfMaterial, EmissionIsMultipliedByItsStrength) {
  const Scene scene =
      with({{"emissiveFactor", {1, 0.5, 0}},
            {"extensions", {{"KHR_materials_emissive_strength", {{"emissiveStrength", 8}}}}}});
  EXPECT_EQ(scene.materials[0].emission, Color(8, 4, 0));
}

TEST_F(GltfMaterial, ClearcoatHasItsOwnTextures) {
  const Material m = material_with("KHR_materials_clearcoat",
                                   {{"clearcoatFactor", 0.5},
                                    {"clearcoatTexture", {{"index", 0}}},
                                    {"clearcoatRoughnessFactor", 0.25},
                                    {"clearcoatRoughnessTexture", {{"index", 0}, {"texCoord", 1}}},
                                    {"clearcoatNormalTexture", {{"index", 0}, {"scale", 2}}}});
  EXPECT_EQ(m.clearcoat, 0.5f);
  EXPECT_EQ(m.clearcoat_roughness, 0.25f);
  EXPECT_TRUE(m.clearcoat_texture && m.clearcoat_roughness_texture && m.clearcoat_normal_texture);
  EXPECT_EQ(m.clearcoat_roughness_texture.uv_set, 1);
  EXPECT_EQ(m.clearcoat_normal_scale, 2);
}

TEST_F(GltfMaterial, SheenColoursAreOfSrgbPictures) {
  const Material m = material_with("KHR_materials_sheen", {{"sheenColorFactor", {0.25, 0.5, 1}},
                                                           {"sheenColorTexture", {{"index", 0}}},
                                                           {"sheenRoughnessFactor", 0.5},
                                                           {"sheenRoughnessTexture", {{"index", 0}}}});
  EXPECT_EQ(m.sheen_color, Color(0.25f, 0.5f, 1));
  EXPECT_EQ(m.sheen_roughness, 0.5f);
  EXPECT_NE(m.sheen_color_texture.picture, m.sheen_roughness_texture.picture) << "decoded in two ways";
}

TEST_F(GltfMaterial, UnlitAndIor) {
  EXPECT_EQ(material_with("KHR_materials_unlit", Json::object()).kind, Material::Kind::unlit);
  EXPECT_EQ(material_with("KHR_materials_ior", {{"ior", 1.25}}).ior, 1.25f);
}

TEST_F(GltfMaterial, SpecularIsALossUnlessItSaysNothing) {
  material_with("KHR_materials_specular", {{"specularFactor", 1}});
  const Scene scene =
      with({{"name", "m"}, {"extensions", {{"KHR_materials_specular", {{"specularFactor", 0.5}}}}}});
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("material 'm': KHR_materials_specular is ignored")));
}

TEST_F(GltfMaterial, SpecularGlossinessIsTakenForADielectric) {
  const Scene scene = with({{"extensions",
                             {{"KHR_materials_pbrSpecularGlossiness",
                               {{"diffuseFactor", {0.5, 0.25, 1, 0.5}}, {"glossinessFactor", 0.75}}}}}});
  EXPECT_EQ(scene.materials[0].base_color, Color(0.5f, 0.25f, 1));
  EXPECT_EQ(scene.materials[0].base_alpha, 0.5f);
  EXPECT_EQ(scene.materials[0].metallic, 0);
  EXPECT_EQ(scene.materials[0].roughness, 0.25f);
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("specular-glossiness is taken for")));
}

TEST_F(GltfMaterial, UnknownExtensionsAreNamed) {
  built_.json["extensionsUsed"] = {"VENDOR_glitter", "KHR_materials_ior"};
  const Scene scene = with({{"extensions", {{"VENDOR_dust", Json::object()}}}});
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("the extension VENDOR_glitter is ignored")));
  EXPECT_THAT(scene.warnings, Contains(HasSubstr("the extension VENDOR_dust is ignored")));
  EXPECT_THAT(scene.warnings, Not(Contains(HasSubstr("KHR_materials_ior"))));
}

// The example of the extension: "the lower left quadrant of the source image, rotated clockwise 90 degrees".
TEST_F(GltfMaterial, ATextureTransformIsThatOfTheSpecification) {
  const Scene scene =
      with({{"emissiveTexture",
             {{"index", 0},
              {"extensions",
               {{"KHR_texture_transform",
                 {{"offset", {0, 1}}, {"rotation", 1.57079632679}, {"scale", {0.5, 0.5}}}}}}}}});
  const auto& t = scene.materials[0].emission_texture.transform;
  const auto at = [&](float u, float v) {
    return Vec2(t[0] * u + t[1] * v + t[2], t[3] * u + t[4] * v + t[5]);
  };
  // What is shown top left, top right and bottom left comes from the quadrant's bottom left, top left, bottom
  // right.
  EXPECT_TRUE(at(0, 0).equalWithAbsError(Vec2(0, 1), 1e-6f));
  EXPECT_TRUE(at(1, 0).equalWithAbsError(Vec2(0, 0.5f), 1e-6f));
  EXPECT_TRUE(at(0, 1).equalWithAbsError(Vec2(0.5f, 1), 1e-6f));
}

TEST_F(GltfMaterial, ATextureTransformScalesBeforeItTurns) {
  const Scene scene = with({{"emissiveTexture",
                             {{"index", 0},
                              {"extensions",
                               {{"KHR_texture_transform",
                                 {{"offset", {5, 7}}, {"rotation", 1.57079632679}, {"scale", {2, 3}}}}}}}}});
  EXPECT_THAT(scene.materials[0].emission_texture.transform,
              testing::Pointwise(testing::FloatNear(1e-6f), {0.f, 3.f, 5.f, -2.f, 0.f, 7.f}));
}

TEST_F(GltfMaterial, TexturesNameTheirSetOfCoordinatesAndATransformMayNameAnother) {
  const auto set_of = [&](const Json& info) {
    return with({{"emissiveTexture", info}}).materials[0].emission_texture.uv_set;
  };
  EXPECT_EQ(set_of({{"index", 0}}), 0);
  EXPECT_EQ(set_of({{"index", 0}, {"texCoord", 1}}), 1);
  const Json transform = {{"KHR_texture_transform", {{"texCoord", 1}}}};
  EXPECT_EQ(set_of({{"index", 0}, {"texCoord", 0}, {"extensions", transform}}), 1);
  EXPECT_EQ(set_of({{"index", 0}, {"texCoord", 2}}), 0);
  EXPECT_THAT(with({{"emissiveTexture", {{"index", 0}, {"texCoord", 2}}}}).warnings,
              Contains(HasSubstr("TEXCOORD_2 is taken for TEXCOORD_0")));
}

TEST_F(GltfMaterial, VariantsChooseMaterialsForMeshes) {
  built_.json["extensions"] = {
      {"KHR_materials_variants", {{"variants", {{{"name", "red"}}, {{"name", "blue"}}}}}}};
  built_.json["meshes"][0]["primitives"][0]["extensions"] = {
      {"KHR_materials_variants",
       {{"mappings", {{{"material", 1}, {"variants", {0}}}, {{"material", 2}, {"variants", {1}}}}}}}};
  built_.json["materials"] = {Json::object(), Json::object(), Json::object()};
  const Scene scene = built_.load();
  ASSERT_EQ(scene.variants.size(), 2u);
  EXPECT_EQ(scene.variants[0].name, "red");
  ASSERT_EQ(scene.variants[1].choices.size(), 1u);
  EXPECT_EQ(scene.variants[1].choices[0].mesh, 0);
  EXPECT_EQ(scene.variants[1].choices[0].material, 2);
  built_.json["materials"].erase(2);
  EXPECT_THAT(built_.refused(), HasSubstr("meshes/0: there is no material 2"));
}

TEST_F(GltfMaterial, PicturesBeyondTheLimitAreRefused) {
  built_.json["materials"] = {{{"emissiveTexture", {{"index", 0}}}}};
  ImportLimits limits;
  limits.picture_pixels = 3;  // corners.png has 4
  try {
    load_scene(folder_.write("built.glb", built_.bytes()), limits);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("images/0: there are 4 pixels in all pictures; accepted: at most 3"));
  }
}

}  // namespace
}  // namespace tessera
