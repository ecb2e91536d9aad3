// SPDX-License-Identifier: Apache-2.0
// Lights, nodes, cameras and animations of glTF as they are seen.
#include "tests/worker/render/gltf_scene.h"

namespace tessera {
namespace {

using testing::GltfRender;
using testing::Json;
using testing::kPi;

class GltfScene : public GltfRender {
 protected:
  // The middle of a white square, lit by nothing but a light at (0.5, 0.5, z) that shines down -Z.
  double under(Json light, double z) {
    built_.json["nodes"] = {built_.json["nodes"][0]};
    built_.json["cameras"][0]["orthographic"]["xmag"] = built_.json["cameras"][0]["orthographic"]["ymag"] =
        1e-3;
    built_.json["extensions"]["KHR_lights_punctual"]["lights"] = {std::move(light)};
    stand(square(material(white())));
    built_.add("nodes",
               {{"translation", {0.5, 0.5, z}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
    return mean(view(load(), {}, 8, 8)).value;
  }
  int count(const Image& image, int channel) {
    int pixels = 0;
    for (const float v : image.plane(channel)) pixels += v > 0.5f;
    return pixels;
  }
};

// A white dielectric without reflection scatters 21/20 / pi at normal incidence (docs/MATERIALS.md).
constexpr double kWhite = 1.05 / kPi;

TEST_F(GltfScene, PointsFallWithTheSquareOfTheirDistanceAndSunsDoNot) {
  const Json point = {{"type", "point"}, {"intensity", 8}, {"color", {0.5, 1, 1}}};
  EXPECT_NEAR(under(point, 2), kWhite * 1, 1e-4);
  EXPECT_NEAR(under(point, 4), kWhite / 4, 1e-4);
  const Json sun = {{"type", "directional"}, {"intensity", 3}};
  EXPECT_NEAR(under(sun, 2), kWhite * 3, 1e-4);
  EXPECT_NEAR(under(sun, 4), kWhite * 3, 1e-4);
}

TEST_F(GltfScene, SpotsShineInTheirCone) {
  Json spot = {
      {"type", "spot"}, {"intensity", 8}, {"spot", {{"innerConeAngle", 0.2}, {"outerConeAngle", 0.4}}}};
  EXPECT_NEAR(under(spot, 2), kWhite * 2, 1e-4);
  const auto aside = [&](double angle) {
    under(spot, 2);
    built_.json["nodes"].back()["translation"] = {0.5 + std::sin(angle) * 2, 0.5, std::cos(angle) * 2};
    return mean(view(load(), {}, 8, 8)).value;
  };
  EXPECT_GT(aside(0.19), 1.8 * kWhite);
  EXPECT_EQ(aside(0.41), 0);
}

TEST_F(GltfScene, VariantsAreChosenByTheSettings) {
  const int grey = material(unlit({0.5, 0.5, 0.5, 1})), red = material(unlit({1, 0, 0, 1})),
            blue = material(unlit({0, 0, 1, 1})), mesh = square(grey);
  built_.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "red"}}, {{"name", "blue"}}};
  built_.json["meshes"][static_cast<std::size_t>(mesh)]["primitives"][0]["extensions"] = {
      {"KHR_materials_variants",
       {{"mappings", {{{"material", red}, {"variants", {0}}}, {{"material", blue}, {"variants", {1}}}}}}}};
  stand(mesh);
  const Scene scene = load();
  const auto seen = [&](const std::string& variant) {
    const Image image = view(scene, {.variant = variant}, 4, 8);
    return Color(image.at(0, 1, 1), image.at(1, 1, 1), image.at(2, 1, 1));
  };
  EXPECT_EQ(seen(""), Color(0.5f, 0.5f, 0.5f));
  EXPECT_EQ(seen("red"), Color(1, 0, 0));
  EXPECT_EQ(seen("blue"), Color(0, 0, 1));
}

// Tiles of 1/4 on a frame of 16 pixels: each covers 16 of them.
TEST_F(GltfScene, EveryInstanceOfAnInstancedNodeIsSeen) {
  const int mesh = square(material(unlit({1, 1, 1, 1})));
  const int moves = built_.accessor<float>({0, 0, 0, 0.5f, 0, 0, 0.25f, 0.75f, 0}, "VEC3"),
            scales = built_.accessor<float>({0.25f, 0.25f, 1, 0.25f, 0.25f, 1, 0.25f, 0.25f, 1}, "VEC3");
  built_.add(
      "nodes",
      {{"mesh", mesh},
       {"extensions",
        {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", moves}, {"SCALE", scales}}}}}}}});
  const Image seen = view(load(), {}, 16, 8);
  EXPECT_EQ(count(seen, 0), 3 * 16);
  EXPECT_EQ(seen.at(0, 1, 14), 1);
  EXPECT_EQ(seen.at(0, 9, 14), 1);
  EXPECT_EQ(seen.at(0, 5, 1), 1);
  EXPECT_EQ(seen.at(0, 5, 14), 0);
}

TEST_F(GltfScene, AnOrthographicCameraSeesThingsAsLargeFarAway) {
  const int mesh = square(material(unlit({1, 1, 1, 1})));
  for (const double z : {0.0, -50.0}) {
    built_.json["nodes"] = {built_.json["nodes"][0]};
    built_.add("nodes", {{"mesh", mesh}, {"translation", {0.25, 0.5, z}}, {"scale", {0.5, 0.25, 1}}});
    EXPECT_EQ(count(view(load(), {}, 16, 8), 0), 8 * 4) << z;
  }
}

TEST_F(GltfScene, APerspectiveCameraSeesThemSmaller) {
  const int mesh = square(material(unlit({1, 1, 1, 1})));
  built_.json["cameras"][0] = {{"type", "perspective"},
                               {"perspective", {{"yfov", 2 * std::atan(0.5)}, {"znear", 1}}}};
  for (const double distance : {2.0, 4.0}) {
    built_.json["nodes"] = {built_.json["nodes"][0]};
    built_.json["nodes"][0]["translation"] = {0.5, 0.5, distance};
    stand(mesh);
    EXPECT_EQ(count(view(load(), {}, 16, 8), 0), 16 * 16 / (distance * distance)) << "of the frame's height";
  }
}

// It crosses the frame while the shutter is open, and turns.
TEST_F(GltfScene, WhatAnAnimationMovesIsTheMeanOfManyStillFrames) {
  const int node = stand(square(material(unlit({1, 1, 1, 1}))), -1);
  const float frame = 1.0f / 24;
  const int times = built_.accessor<float>({0, frame}, "SCALAR"),
            moves = built_.accessor<float>({-1, 0, 0, 1, 0.5f, 0}, "VEC3"),
            turns = built_.accessor<float>({0, 0, 0, 1, 0, 0, std::sin(0.4f), std::cos(0.4f)}, "VEC4");
  built_.json["animations"] = {
      {{"samplers", {{{"input", times}, {"output", moves}}, {{"input", times}, {"output", turns}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", node}, {"path", "translation"}}}},
         {{"sampler", 1}, {"target", {{"node", node}, {"path", "rotation"}}}}}}}};
  Scene scene = load();
  constexpr int kEdge = 8, kFrames = 128, kSamples = 1024;
  scene.cameras[0].shutter_close = 1;
  const Image blurred = view(scene, {}, kEdge, kSamples);
  Image mean({0, 0, kEdge, kEdge}, 1);
  for (int i = 0; i < kFrames; ++i) {
    scene.cameras[0].shutter_open = scene.cameras[0].shutter_close = (static_cast<float>(i) + 0.5f) / kFrames;
    const Image still = view(scene, {}, kEdge, 8);
    for (int y = 0; y < kEdge; ++y)
      for (int x = 0; x < kEdge; ++x) mean.at(0, x, y) += still.at(0, x, y) / kFrames;
  }
  double least = 1, most = 0;
  for (int y = 0; y < kEdge; ++y)
    for (int x = 0; x < kEdge; ++x) {
      const double p = mean.at(0, x, y), own = p * (1 - p);
      // Of both; the still ones have 8 samples each, and their times are a grid.
      const double error = std::sqrt(own / kSamples + own / (8 * kFrames)) + 0.5 / kFrames;
      EXPECT_NEAR(blurred.at(0, x, y), p, 4 * error) << x << ", " << y;
      least = std::min(least, p), most = std::max(most, p);
    }
  EXPECT_LT(least, 0.4);
  EXPECT_GT(most, 0.6);
}

}  // namespace
}  // namespace tessera
