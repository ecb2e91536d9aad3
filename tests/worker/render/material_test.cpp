// SPDX-License-Identifier: Apache-2.0
// What textures, vertex colours and normal maps make of materials at a point.
#include <gtest/gtest.h>

#include <limits>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/painted.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

TEST(Material, ANormalMapLeansTheNormalAlongTheTexture) {
  for (const bool flipped : {false, true}) {
    Painted painted({.kind = Material::Kind::metallic_roughness}, flipped);
    painted.material().normal_texture = {.picture = painted.add_picture(1, 3, {0.5f, 0.5f, 1})};
    std::vector<float>& pixels = painted.scene.pictures[0].pixels;
    EXPECT_LT(length(painted.bsdf({0, 0, 1}).frame.z - Vec3(0, 0, 1)), 1e-6f);
    pixels = {0.8f, 0.5f, 0.9f};  // towards growing u
    EXPECT_LT(length(painted.bsdf({0, 0, 1}).frame.z - Vec3(flipped ? -0.6f : 0.6f, 0, 0.8f)), 1e-5f);
    pixels = {0.5f, 0.8f, 0.9f};  // green is up
    EXPECT_LT(length(painted.bsdf({0, 0, 1}).frame.z - Vec3(0, 0.6f, 0.8f)), 1e-5f);
  }
}

TEST(Material, ANormalMapLeansAlongTheSetAndTheTransformOfItsTexture) {
  Painted painted({.kind = Material::Kind::metallic_roughness});
  Texture& map = painted.material().normal_texture;
  map = {.picture = painted.add_picture(1, 3, {0.8f, 0.5f, 0.9f})};
  map.transform = {0, 1, 0, -1, 0, 0};  // u' = v, which grows downwards
  EXPECT_LT(length(painted.bsdf({0, 0, 1}).frame.z - Vec3(0, -0.6f, 0.8f)), 1e-5f);
  map.transform = {1, 0, 0, 0, 1, 0};
  map.uv_set = 1;
  for (const Vec2& uv : painted.mesh().uvs) painted.mesh().uvs2.push_back({1 - uv.x, uv.y});
  EXPECT_LT(length(painted.bsdf({0, 0, 1}).frame.z - Vec3(-0.6f, 0, 0.8f)), 1e-5f);
}

TEST(Material, AShadingNormalIsBentSoThatMirrorDirectionsStayAboveTheSurface) {
  Random random(8);
  Painted painted({.kind = Material::Kind::metallic_roughness});
  painted.material().normal_texture = {.picture = painted.add_picture(1, 3, {0, 0, 0})};
  for (int i = 0; i < 5000; ++i) {
    const Vec2 u = random.pair(), v = random.pair();
    const Vec3 n = from_square(u.x, 0.5 + 0.5 * u.y);
    painted.scene.pictures[0].pixels = {0.5f + 0.5f * n.x, 0.5f + 0.5f * n.y, 0.5f + 0.5f * n.z};
    const Bsdf b = painted.bsdf(from_square(v.x, 0.505 + 0.49 * v.y));
    const Vec3 mirrored = b.frame.to_world({-b.wo.x, -b.wo.y, b.wo.z});
    EXPECT_GT(b.wo.z, 0);
    EXPECT_GT(dot(mirrored, b.ng), 0);
  }
}

TEST(Material, RoughnessAndMetalnessComeFromGreenAndBlue) {
  Painted painted({.kind = Material::Kind::metallic_roughness,
                   .base_color = Color(0.5f, 0.4f, 0.3f),
                   .metallic = 1,
                   .roughness = 0.5f});
  painted.material().metallic_roughness_texture = {.picture = painted.add_picture(1, 3, {0, 0.5f, 1})};
  const Bsdf metal = painted.bsdf({0, 0, 1});
  EXPECT_FLOAT_EQ(metal.lobes[0].alpha, 0.0625f);
  EXPECT_FALSE(has_diffuse(metal));
  EXPECT_FLOAT_EQ(metal.lobes[0].f0.y, 0.4f);
  painted.scene.pictures[0].pixels[2] = 0;
  EXPECT_FLOAT_EQ(painted.bsdf({0, 0, 1}).lobes[0].f0.x, 0.04f);
}

// Every factor of a glTF extension comes from its own channel.
TEST(Material, FactorsOfExtensionsAreMultipliedByTheirChannels) {
  const auto looked_at = [](auto set) {
    Painted painted({.kind = Material::Kind::metallic_roughness, .base_color = Color(0.5f, 0.5f, 0.5f)});
    const Texture texture{.picture = painted.add_picture(1, 4, {0.5f, 0.6f, 0.7f, 0.8f})};
    set(painted.material(), texture);
    Material plain = painted.material();
    for (Texture* t : {&plain.transmission_texture, &plain.clearcoat_texture, &plain.sheen_color_texture,
                       &plain.clearcoat_roughness_texture, &plain.sheen_roughness_texture})
      *t = {};
    plain.transmission *= 0.5f;
    plain.clearcoat *= 0.5f;
    plain.clearcoat_roughness *= 0.6f;
    plain.sheen_roughness *= 0.8f;
    plain.sheen_color *= Color(0.5f, 0.6f, 0.7f);
    const Bsdf a = painted.bsdf({0, 0, 1}), b = Painted(plain).bsdf({0, 0, 1});
    ASSERT_EQ(a.lobes.size(), b.lobes.size());
    for (std::size_t i = 0; i < a.lobes.size(); ++i) {
      EXPECT_FLOAT_EQ(a.lobes[i].alpha, b.lobes[i].alpha) << i;
      EXPECT_LT(length(a.lobes[i].color - b.lobes[i].color), 1e-6f) << i;
    }
    ASSERT_EQ(a.layers.size(), b.layers.size());
    for (std::size_t i = 0; i < a.layers.size(); ++i) EXPECT_EQ(a.layers[i].coat, b.layers[i].coat);
  };
  looked_at([](Material& m, const Texture& t) { m.transmission = 0.8f, m.transmission_texture = t; });
  looked_at([](Material& m, const Texture& t) {
    m.clearcoat = m.clearcoat_roughness = 0.9f;
    m.clearcoat_texture = m.clearcoat_roughness_texture = t;
  });
  looked_at([](Material& m, const Texture& t) {
    m.sheen_color = Color(0.9f, 0.8f, 0.7f), m.sheen_roughness = 0.9f;
    m.sheen_color_texture = m.sheen_roughness_texture = t;
  });
}

TEST(Material, BothSidesScatter) {
  Painted painted({.base_color = Color(0.5f, 0.5f, 0.5f), .double_sided = false});
  EXPECT_FALSE(is_black(evaluate(painted.bsdf({0, 0, -1}), {0, 0, -1}).f()));
  EXPECT_TRUE(is_black(evaluate(painted.bsdf({0, 0, -1}), {0, 0, 1}).f()));
}

// The point looked at has u = 0.6 and v = 0.7: barycentric (0.3, 0.3) of the lower right triangle.
TEST(Material, TexturesUseTheirSetAndTransform) {
  Painted painted({.kind = Material::Kind::unlit, .base_color = Color(1, 1, 1)});
  Texture& texture = painted.material().base_color_texture;
  texture = {.picture = painted.add_picture(4, 1, {0, 1, 2, 3})};  // red is 4 u - 0.5
  const auto shown = [&] {
    return painted
        .look({0, 0, 1}, [](const auto& materials, const auto& g, const auto& hit,
                            const auto& s) { return materials.shown(g, hit, s); })
        .x;
  };
  EXPECT_NEAR(shown(), 4 * 0.6f - 0.5f, 1e-5f);
  texture.uv_set = 1;  // there is none yet: the first
  EXPECT_NEAR(shown(), 4 * 0.6f - 0.5f, 1e-5f);
  for (const Vec2& uv : painted.mesh().uvs) painted.mesh().uvs2.push_back(uv * 0.5f);
  EXPECT_NEAR(shown(), 4 * 0.3f - 0.5f, 1e-5f);
  texture.transform = {0.5f, 1, 0.1f, 0, 0, 0};  // of (0.3, 0.35): 0.15 + 0.35 + 0.1
  EXPECT_NEAR(shown(), 4 * 0.6f - 0.5f, 1e-5f);
}

TEST(Material, EmissionUsesTheSetAndTransformOfItsTexture) {
  Painted painted({.emission = Color(2, 2, 2)});
  Texture& texture = painted.material().emission_texture;
  texture = {.picture = painted.add_picture(4, 1, {0, 1, 2, 3}), .uv_set = 1};
  for (const Vec2& uv : painted.mesh().uvs) painted.mesh().uvs2.push_back(uv * 0.5f);
  texture.transform = {0.5f, 1, 0.1f, 0, 0, 0};
  painted.look({0, 0, 1}, [](const auto& materials, const auto& g, const auto& hit, const auto& s) {
    EXPECT_NEAR(materials.emission(0, s).x, 2 * (4 * 0.6f - 0.5f), 1e-4f);
    EXPECT_EQ(materials.emission(0, s), materials.emission(0, {g, hit}));
  });
  EXPECT_NEAR(Materials(painted.scene).mean_emission(0).x, 2 * 1.5f, 1e-5f);
}

TEST(Material, AMixEmitsWhatItIsMadeOf) {
  const Material lamp{.emission = Color(4, 4, 4)}, dark{};
  Painted painted({lamp, dark, {.kind = Material::Kind::mix, .first = 0, .second = 1, .mix = 0.25f}});
  painted.material().mix_texture = {.picture = painted.add_picture(1, 1, {0.5f})};
  const Materials materials(painted.scene);
  EXPECT_TRUE(materials.emits(0) && materials.emits(2));
  EXPECT_FALSE(materials.emits(1));
  EXPECT_FLOAT_EQ(materials.emission(2, Vec2(0, 0)).x, 3.5f);
  EXPECT_FLOAT_EQ(materials.mean_emission(2).x, 3.5f);
}

TEST(Material, AMixTextureMultipliesTheShare) {
  const Material black{.base_color = Color(0, 0, 0)}, white{.base_color = Color(1, 1, 1)};
  Painted painted({black, white, {.kind = Material::Kind::mix, .first = 0, .second = 1, .mix = 0.5f}});
  painted.material().mix_texture = {.picture = painted.add_picture(1, 3, {0.4f, 1, 1})};
  EXPECT_NEAR(albedo(painted.bsdf({0, 0, 1})).x, 0.2f, 1e-6f);
}

// Pictures of floats hold anything; a share stays one.
TEST(Material, SharesFromTexturesStayWithinBounds) {
  for (const float wild : {-3.0f, 7.0f, 1e30f, std::numeric_limits<float>::quiet_NaN()}) {
    Material m{.kind = Material::Kind::metallic_roughness, .base_color = Color(1, 1, 1), .metallic = 0.5f};
    m.transmission = m.clearcoat = m.clearcoat_roughness = m.sheen_roughness = 0.5f;
    m.sheen_color = Color(0.5f, 0.5f, 0.5f);
    Painted painted({m, m, {.kind = Material::Kind::mix, .first = 0, .second = 1}});
    painted.material().alpha = Material::Alpha::blend;
    const Texture t{.picture = painted.add_picture(1, 4, {wild, wild, wild, wild})};
    Material& a = painted.scene.materials[0];
    a.metallic_roughness_texture = a.transmission_texture = a.clearcoat_texture = t;
    a.clearcoat_roughness_texture = a.sheen_roughness_texture = t;
    painted.material().mix_texture = painted.material().base_color_texture = t;
    const float opacity = painted.opacity();
    EXPECT_TRUE(opacity >= 0 && opacity <= 1);
    painted.look({0, 0, 1}, [](const auto& materials, const auto& g, const auto& hit, const auto& s) {
      const Bsdf b = materials.bsdf(g, hit, s, {0, 0, -1});
      const Color c = evaluate(b, unit(Vec3(0.3f, 0.2f, 1))).f();
      EXPECT_TRUE(is_finite(c) && c.x >= 0) << c;
      EXPECT_TRUE(is_finite(sample(b, 0.3f, {0.2f, 0.6f}).weight()));
    });
  }
}

TEST(Material, VertexColoursMultiplyTheBaseColourAndAlpha) {
  Painted painted(
      {.base_color = Color(0.5f, 0.5f, 0.5f), .alpha = Material::Alpha::blend, .base_alpha = 0.5f});
  EXPECT_FLOAT_EQ(painted.opacity(), 0.5f);
  // The corners of the triangle looked at are 0, 1 and 3; the point lies by (0.4, 0.3, 0.3) between them.
  painted.mesh().colors = {{1, 0, 0, 1}, {0, 1, 0, 1}, {9, 9, 9, 9}, {0, 0, 1, 0}};
  EXPECT_LT(length(albedo(painted.bsdf({0, 0, 1})) - Color(0.2f, 0.15f, 0.15f)), 1e-6f);
  EXPECT_FLOAT_EQ(painted.opacity(), 0.35f);
}

TEST(Material, AMaskIsThereOrNotAndABlendInPart) {
  using Alpha = Material::Alpha;
  Painted painted({.base_alpha = 0.8f, .alpha_cutoff = 0.5f});
  painted.material().base_color_texture = {.picture = painted.add_picture(1, 4, {1, 1, 1, 0.5f})};
  const auto opacity_of = [&](Alpha alpha) {
    painted.material().alpha = alpha;
    EXPECT_EQ(Materials(painted.scene).masked(0), alpha != Alpha::opaque);
    return painted.opacity();
  };
  EXPECT_EQ(opacity_of(Alpha::opaque), 1);
  EXPECT_EQ(opacity_of(Alpha::mask), 0);
  EXPECT_FLOAT_EQ(opacity_of(Alpha::blend), 0.4f);
  painted.material().alpha_cutoff = 0.3f;
  EXPECT_EQ(opacity_of(Alpha::mask), 1);
}

TEST(Material, AnUnlitSurfaceShowsItsColour) {
  Painted painted({.kind = Material::Kind::unlit, .base_color = Color(0.5f, 0.25f, 1)});
  painted.mesh().colors.assign(4, {1, 0.5f, 1, 1});
  EXPECT_TRUE(Materials(painted.scene).unlit(0));
  EXPECT_FALSE(Materials(Painted({Material{}}).scene).unlit(0));
  painted.look({0, 0, 1}, [](const auto& materials, const auto& g, const auto& hit, const auto& s) {
    EXPECT_EQ(materials.shown(g, hit, s), Color(0.5f, 0.125f, 1));
  });
}

}  // namespace
}  // namespace tessera::tracer
