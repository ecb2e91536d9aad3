// SPDX-License-Identifier: Apache-2.0
// glTF files made in a test, loaded and rendered: a camera without perspective looks along -Z at the square
// from (0, 0, 0) to (1, 1, 0) and sees nothing beside it.
#pragma once

#include <string>

#include "core/png.h"
#include "core/scene/srgb.h"
#include "tests/core/scene/gltf_builder.h"
#include "tests/worker/render/scenes.h"

namespace tessera::testing {

using Json = nlohmann::json;

class GltfRender : public ::testing::Test {
 protected:
  GltfRender() {
    built_.json["cameras"] = {{{"type", "orthographic"},
                               {"orthographic", {{"xmag", 0.5}, {"ymag", 0.5}, {"znear", 0}, {"zfar", 99}}}}};
    built_.json["nodes"] = {{{"camera", 0}, {"translation", {0.5, 0.5, 9}}}};
    built_.json["materials"] = Json::array();
  }

  int material(const Json& m) { return built_.add("materials", m); }
  // What reflects nothing seen head on, with an extension or none.
  static Json black(const Json& extensions = Json::object()) {
    Json m = {{"pbrMetallicRoughness",
               {{"baseColorFactor", {0, 0, 0, 1}}, {"metallicFactor", 0}, {"roughnessFactor", 0}}},
              {"extensions", extensions}};
    if (!m["extensions"].contains("KHR_materials_ior")) m["extensions"]["KHR_materials_ior"] = {{"ior", 1}};
    return m;
  }
  static Json emitting(double radiance) {
    Json m = black({{"KHR_materials_emissive_strength", {{"emissiveStrength", radiance}}}});
    m["emissiveFactor"] = {1, 1, 1};
    return m;
  }
  // A Lambertian surface as far as glTF has one: nothing reflects at normal incidence.
  static Json white() {
    Json m = black();
    m["pbrMetallicRoughness"] = {{"metallicFactor", 0}, {"roughnessFactor", 1}};
    return m;
  }
  static Json unlit(const Json& color) {
    return {{"pbrMetallicRoughness", {{"baseColorFactor", color}}},
            {"extensions", {{"KHR_materials_unlit", Json::object()}}}};
  }

  // The mesh of a square, front to +Z or to -Z, with further attributes.
  int square(int material, const Json& attributes = Json::object(), bool front = true) {
    Json all = attributes;
    all["POSITION"] = built_.square();
    const std::vector<std::uint8_t> to = {0, 1, 2, 0, 2, 3}, fro = {0, 2, 1, 0, 3, 2};
    return built_.mesh({{"attributes", all},
                        {"indices", built_.accessor(front ? to : fro, "SCALAR")},
                        {"material", material}});
  }
  int stand(int mesh, double x = 0, double y = 0, double z = 0) {
    return built_.add("nodes", {{"mesh", mesh}, {"translation", {x, y, z}}});
  }
  // Texture coordinates of which the picture's top left corner is that of the square.
  int upright() { return built_.accessor<float>({0, 1, 1, 1, 1, 0, 0, 0}, "VEC2"); }
  // A picture of two halves, of linear colours, and its texture, which is clamped.
  int halves(const std::array<float, 4>& left, const std::array<float, 4>& right) {
    Image image({0, 0, 16, 4}, 4);
    for (int c = 0; c < 4; ++c)
      for (int y = 0; y < 4; ++y)
        for (int x = 0; x < 16; ++x) image.at(c, x, y) = (x < 8 ? left : right)[static_cast<std::size_t>(c)];
    const std::string name = "halves" + std::to_string(pictures_++) + ".png";
    write_png(folder_.path() / name, image);
    const int source = built_.add("images", {{"uri", name}});
    const int sampler = built_.add("samplers", {{"wrapS", 33071}, {"wrapT", 33071}});
    return built_.add("textures", {{"source", source}, {"sampler", sampler}});
  }

  // Under a sky of that radiance in all directions: glTF has none.
  Scene load(float sky = 0) {
    Scene scene = load_scene(folder_.write("built.glb", built_.bytes()));
    scene.environment = {.radiance = Color(sky, sky, sky)};
    return scene;
  }
  static Image view(const Scene& scene, const RenderSettings& like = {}, int edge = 16, int samples = 64) {
    RenderSettings settings = like;
    settings.size = {edge, edge};
    const auto ready = prepare(std::make_shared<const Scene>(scene), settings);
    return developed(render(*ready, settings, 0, {0, 0, edge, edge}, {0, samples}).sums,
                     FilmLayout(settings.aovs), channels_of(Aov::color), Part::all);
  }
  // Means over the columns from x0 to x1 of the frame, and the standard error.
  struct Mean {
    double value, error;
  };
  static Mean mean(const Image& image, int channel = 0, int x0 = 0, int x1 = 0) {
    const Region r = image.region();
    if (x1 == 0) x1 = r.x1;
    double sum = 0, squares = 0;
    for (int y = 0; y < r.y1; ++y)
      for (int x = x0; x < x1; ++x)
        sum += image.at(channel, x, y), squares += square_of(image.at(channel, x, y));
    const double n = double(x1 - x0) * r.y1;
    return {sum / n, std::sqrt(std::max(0.0, squares / n - square_of(sum / n)) / n)};
  }
  static double square_of(double x) { return x * x; }
  static void expect_mean(const Image& image, double expected, const char* what, double slack = 1e-3) {
    const Mean m = mean(image);
    EXPECT_NEAR(m.value, expected, 4 * m.error + slack * expected) << what;
  }

  const Folder folder_;
  GltfBuilder built_;
  int pictures_ = 0;
};

}  // namespace tessera::testing
