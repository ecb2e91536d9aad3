// SPDX-License-Identifier: Apache-2.0
// Materials and textures of glTF as they are seen, feature by feature.
#include "tests/worker/render/gltf_scene.h"

namespace tessera {
namespace {

using testing::GltfRender;
using testing::Json;

class GltfSurface : public GltfRender {
 protected:
  // The square of that material, alone under a sky.
  Image alone(const Json& m, float sky = 1, int samples = 64) {
    stand(square(material(m)));
    const Image seen = view(load(sky), {}, 16, samples);
    built_.json["nodes"].erase(1);
    return seen;
  }
};

constexpr std::array<float, 4> kRed{1, 0, 0, 1}, kGreen{0, 1, 0, 1};

TEST_F(GltfSurface, EmissiveStrengthMultiplies) {
  EXPECT_EQ(mean(alone(emitting(1))).value, 1);
  EXPECT_EQ(mean(alone(emitting(8))).value, 8);
}

TEST_F(GltfSurface, AHigherIorReflectsMoreByTheSquareOfItsStep) {
  for (const double ior : {1.25, 1.5, 2.0})
    expect_mean(alone(black({{"KHR_materials_ior", {{"ior", ior}}}})), std::pow((ior - 1) / (ior + 1), 2),
                "ior");
}

TEST_F(GltfSurface, AMetalReflectsItsColour) {
  const Json pbr = {{"baseColorFactor", {0.75, 0.5, 0.25, 1}}, {"metallicFactor", 1}, {"roughnessFactor", 0}};
  const Image seen = alone({{"pbrMetallicRoughness", pbr}}, 2);
  for (int c = 0; c < 3; ++c) EXPECT_NEAR(mean(seen, c).value, 1.5 - 0.5 * c, 2e-3) << c;
}

TEST_F(GltfSurface, TransmissionShowsWhatIsBehindLessThePanesReflection) {
  Json pane = black(
      {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}, {"KHR_materials_ior", {{"ior", 1.5}}}});
  pane["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 1};
  stand(square(material(pane)));
  stand(square(material(emitting(3))), 0, 0, -1);
  expect_mean(view(load(), {}, 16, 256), 3 * (1 - 2 * 0.04 / 1.04), "pane");
}

TEST_F(GltfSurface, HalfOfTransmissionShowsHalfOfIt) {
  for (const double share : {0.0, 0.5, 1.0}) {
    built_.json["nodes"] = {built_.json["nodes"][0]};
    Json pane = black({{"KHR_materials_transmission", {{"transmissionFactor", share}}}});
    pane["pbrMetallicRoughness"]["baseColorFactor"] = {1, 0.5, 0, 1};
    stand(square(material(pane)));
    stand(square(material(emitting(4))), 0, 0, -1);
    const Image seen = view(load(), {.max_bounces = 0}, 16, 256);
    const Mean red = mean(seen, 0), green = mean(seen, 1);
    EXPECT_NEAR(red.value, 4 * share, 4 * red.error + 1e-4) << share;
    EXPECT_NEAR(green.value, 2 * share, 4 * green.error + 1e-4) << share;
    EXPECT_EQ(mean(seen, 2).value, 0) << share;
  }
}

TEST_F(GltfSurface, AVolumeAbsorbsByItsThickness) {
  for (const double depth : {0.5, 2.0}) {
    built_.json["nodes"] = {built_.json["nodes"][0]};
    Json m =
        black({{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
               {"KHR_materials_volume",
                {{"thicknessFactor", 1}, {"attenuationColor", {0.5, 0.25, 1}}, {"attenuationDistance", 3}}}});
    m["pbrMetallicRoughness"]["baseColorFactor"] = {1, 1, 1, 1};
    const int glass = material(m);
    stand(square(glass));
    stand(square(glass, Json::object(), false), 0, 0, -depth);
    stand(square(material(emitting(4))), 0, 0, -5);
    const Image seen = view(load());
    EXPECT_NEAR(mean(seen, 0).value, 4 * std::pow(0.5, depth / 3), 1e-4);
    EXPECT_NEAR(mean(seen, 1).value, 4 * std::pow(0.25, depth / 3), 1e-4);
    EXPECT_NEAR(mean(seen, 2).value, 4, 1e-4);
  }
}

TEST_F(GltfSurface, AClearcoatAddsItsReflectionAndTakesItFromTheBase) {
  for (const double coat : {0.0, 0.5, 1.0}) {
    const Json extension = {{"KHR_materials_clearcoat", {{"clearcoatFactor", coat}}}};
    expect_mean(alone(black(extension), 2), 2 * 0.04 * coat, "on black");
    Json metal = black(extension);
    metal["pbrMetallicRoughness"] = {{"metallicFactor", 1}, {"roughnessFactor", 0}};
    expect_mean(alone(metal, 2), 2, "on a white metal");
  }
}

TEST_F(GltfSurface, SheenIsBrightestAtGrazingAngles) {
  const auto brightness = [&](double sheen, float cosine) {
    const Json e = {{"KHR_materials_sheen",
                     {{"sheenColorFactor", {sheen, sheen, sheen}}, {"sheenRoughnessFactor", 0.5}}}};
    stand(square(material(black(e))));
    Scene scene = load(1);
    built_.json["nodes"].erase(1);
    const Vec3 middle(0.5f, 0.5f, 0);
    scene.cameras = {
        testing::camera_at(middle + Vec3(std::sqrt(1 - cosine * cosine), 0, cosine) * 9, middle, 1e-3f)};
    return mean(view(scene, {}, 16, 256));
  };
  double before = 0;
  for (const float cosine : {1.0f, 0.6f, 0.3f}) {
    const Mean with = brightness(1, cosine), without = brightness(0, cosine);
    const double added = with.value - without.value;
    EXPECT_GT(added, before + 4 * (with.error + without.error)) << cosine;
    before = added;
  }
}

TEST_F(GltfSurface, UnlitIsItsColourWhateverTheLight) {
  for (const float sky : {0.0f, 3.0f}) {
    const Image seen = alone(unlit({0.5, 0.25, 1, 1}), sky, 8);
    EXPECT_EQ(mean(seen, 0).value, 0.5);
    EXPECT_EQ(mean(seen, 1).value, 0.25);
    EXPECT_EQ(mean(seen, 2).value, 1);
  }
}

TEST_F(GltfSurface, ATextureTransformPicksAPartOfThePicture) {
  const int picture = halves(kRed, kGreen);
  for (const double offset : {0.125, 0.625}) {
    Json lit = emitting(1);
    lit["emissiveTexture"] = {
        {"index", picture},
        {"extensions", {{"KHR_texture_transform", {{"offset", {offset, 0}}, {"scale", {0.25, 1}}}}}}};
    built_.json["nodes"] = {built_.json["nodes"][0]};
    stand(square(material(lit), {{"TEXCOORD_0", upright()}}));
    const Image seen = view(load());
    EXPECT_NEAR(mean(seen, offset < 0.5 ? 0 : 1).value, 1, 1e-3);
    EXPECT_NEAR(mean(seen, offset < 0.5 ? 1 : 0).value, 0, 1e-3);
  }
}

TEST_F(GltfSurface, ATextureLiesAsItsCoordinatesSay) {
  Json lit = emitting(1);
  lit["emissiveTexture"] = {{"index", halves(kRed, kGreen)}};
  stand(square(material(lit), {{"TEXCOORD_0", upright()}}));
  const Image seen = view(load());
  EXPECT_NEAR(mean(seen, 0, 0, 6).value, 1, 1e-3);
  EXPECT_NEAR(mean(seen, 1, 10, 16).value, 1, 1e-3);
  EXPECT_NEAR(mean(seen, 0, 10, 16).value, 0, 1e-3);
}

TEST_F(GltfSurface, ATextureMayUseTheSecondSet) {
  const int left = built_.accessor<float>({0.2f, 0, 0.2f, 0, 0.2f, 0, 0.2f, 0}, "VEC2"),
            right = built_.accessor<float>({0.8f, 0, 0.8f, 0, 0.8f, 0, 0.8f, 0}, "VEC2"),
            picture = halves(kRed, kGreen);
  for (const int set : {0, 1}) {
    Json lit = emitting(1);
    lit["emissiveTexture"] = {{"index", picture}, {"texCoord", set}};
    built_.json["nodes"] = {built_.json["nodes"][0]};
    stand(square(material(lit), {{"TEXCOORD_0", left}, {"TEXCOORD_1", right}}));
    const Image seen = view(load());
    EXPECT_NEAR(mean(seen, set).value, 1, 1e-3);
    EXPECT_NEAR(mean(seen, 1 - set).value, 0, 1e-3);
  }
}

TEST_F(GltfSurface, VertexColoursAreBlendedBetweenTheCorners) {
  const int colors = built_.accessor<float>({0, 1, 1, 1, 1, 1, 1, 1, 1, 0, 1, 1}, "VEC3");
  stand(square(material(unlit({1, 0.5, 1, 1})), {{"COLOR_0", colors}}));
  const Image seen = view(load());
  for (int x = 0; x < 16; ++x) EXPECT_NEAR(mean(seen, 0, x, x + 1).value, (x + 0.5) / 16, 3e-3) << x;
  EXPECT_EQ(mean(seen, 1).value, 0.5);
}

TEST_F(GltfSurface, AMaskHasHolesWhereItsAlphaIsBelowTheCutoff) {
  Json paper = unlit({1, 1, 1, 1});
  paper["pbrMetallicRoughness"]["baseColorTexture"] = {{"index", halves({1, 0, 0, 1}, {0.2f, 0, 0, 0.2f})}};
  paper["alphaMode"] = "MASK";
  stand(square(material(paper), {{"TEXCOORD_0", upright()}}));
  stand(square(material(emitting(3))), 0, 0, -1);
  const Image seen = view(load());
  EXPECT_NEAR(mean(seen, 1, 0, 6).value, 0, 1e-3) << "the paper is red";
  EXPECT_NEAR(mean(seen, 0, 0, 6).value, 1, 1e-3);
  EXPECT_NEAR(mean(seen, 1, 10, 16).value, 3, 1e-3) << "a hole shows what is behind";
}

TEST_F(GltfSurface, ABlendShowsItsShare) {
  Json veil = black();
  veil["pbrMetallicRoughness"]["baseColorFactor"] = {0, 0, 0, 0.25};
  veil["alphaMode"] = "BLEND";
  stand(square(material(veil)));
  stand(square(material(emitting(4))), 0, 0, -1);
  expect_mean(view(load(), {}, 16, 256), 3, "blend");
}

// A normal of (0.6, 0, 0.8), which a sun in front meets at that cosine. Its bytes are (204, 128, 230).
TEST_F(GltfSurface, ANormalMapLeansTheSurface) {
  const auto byte = [](int v) { return from_srgb(static_cast<float>(v) / 255); };
  const std::array<float, 4> lean{byte(204), byte(128), byte(230), 1};
  const int map = halves(lean, lean), uvs = upright();
  const auto lit = [&](bool mapped, float x, float z) {
    Json m = white();
    if (mapped) m["normalTexture"] = {{"index", map}};
    built_.json["nodes"] = {built_.json["nodes"][0]};
    stand(square(material(m), {{"TEXCOORD_0", uvs}}));
    Scene scene = load();
    scene.suns.push_back({Vec3(-x, 0, -z), {1, 1, 1}});
    return mean(view(scene, {}, 8, 8)).value;
  };
  EXPECT_NEAR(lit(true, 0, 1) / lit(false, 0, 1), 0.8, 0.01);
  EXPECT_GT(lit(true, 0.6f, 0.8f), 1.1 * lit(false, 0.6f, 0.8f)) << "it faces a sun at its right";
  EXPECT_LT(lit(true, -0.6f, 0.8f), 0.5 * lit(false, -0.6f, 0.8f)) << "and not one at its left";
}

TEST_F(GltfSurface, OnlyADoubleSidedSurfaceEmitsFromItsBack) {
  for (const bool front : {true, false})
    for (const bool both : {true, false}) {
      Json lit = emitting(2);
      lit["doubleSided"] = both;
      built_.json["nodes"] = {built_.json["nodes"][0]};
      stand(square(material(lit), Json::object(), front));
      EXPECT_EQ(mean(view(load())).value, front || both ? 2 : 0) << front << both;
    }
}

}  // namespace
}  // namespace tessera
