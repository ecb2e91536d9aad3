// SPDX-License-Identifier: Apache-2.0
// Layered and mixed materials: plastic, translucent sheets, the extensions of glTF, mixes.
#include "tests/worker/render/bsdf_cases.h"
#include "worker/render/bsdf/diffuse.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Kind = Material::Kind;

const std::vector<Vec3>& directions() {
  static const std::vector<Vec3> all{direction_at(0.9f), unit(Vec3(-0.5f, 0.2f, 0.4f)),
                                     unit(Vec3(1, -1, 0.1f)), unit(Vec3(-0.3f, -0.3f, -0.6f)),
                                     direction_at(-0.2f)};
  return all;
}

// Both scatter the same, from everywhere to everywhere.
void expect_same(const BsdfCase& a, const BsdfCase& b, float tolerance = 1e-6f) {
  const Seen seen_a(a), seen_b(b);
  for (const Vec3& wo : directions())
    for (const Vec3& wi : directions()) {
      const Color fa = evaluate(seen_a.from(wo), wi).f(), fb = evaluate(seen_b.from(wo), wi).f();
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(fa[k], fb[k], tolerance * (1 + fa[k])) << a.name << wo << wi;
    }
}

TEST(Translucent, ScattersBackAndThroughByLambert) {
  const BsdfCase c = cases::diffuse().back();
  for (const float side : {1.0f, -1.0f}) {
    const Bsdf b = Seen(c).from(direction_at(side * 0.6f));
    const Material& m = c.materials.back();
    EXPECT_LT(length(evaluate(b, {0, 0, side}).diffuse - m.base_color * kInvPi), 1e-6f);
    EXPECT_LT(length(evaluate(b, {0, 0, -side}).diffuse - m.transmission_color * kInvPi), 1e-6f);
    EXPECT_TRUE(has_diffuse(b));
    Random random(1);
    for (int i = 0; i < 100; ++i) {
      const float lobe = random.number();
      EXPECT_FALSE(sample(b, lobe, random.pair()).crossed);
    }
  }
}

TEST(Translucent, ASheetOfSumOneLosesNothing) {
  const BsdfCase c{"",
                   {{.kind = Kind::translucent,
                     .base_color = Color(0.3f, 0.9f, 0.5f),
                     .transmission_color = Color(0.7f, 0.1f, 0.5f)}}};
  const Color all = integral_over_directions(
      Square(), 200, [b = Seen(c).from(direction_at(0.3f))](const Vec3& wi) { return evaluate(b, wi).f(); });
  for (int k = 0; k < 3; ++k) EXPECT_NEAR(all[k], 1, 1e-3f);
}

// Saunderson's series counts what goes to and fro under the boundary, so a white base returns all that
// enters.
TEST(Plastic, SmoothAndWhiteItLosesNothing) {
  for (const float ior : {1.2f, 1.5f, 2.5f}) {
    const Painted painted({.kind = Kind::plastic, .base_color = Color(1, 1, 1), .roughness = 0, .ior = ior});
    for (const float cosine : {0.98f, 0.5f, 0.1f}) {
      const Bsdf b = painted.bsdf(direction_at(cosine));
      const Color base =
          integral_over_directions(Square(), 200, [&](const Vec3& wi) { return evaluate(b, wi).f(); });
      EXPECT_NEAR(base.x + dielectric_fresnel(cosine, ior).reflectance, 1, 3e-3f) << ior << " " << cosine;
      EXPECT_NEAR(albedo(b).x, 1, 1e-3f);
    }
  }
}

TEST(Plastic, WithTheIndexOfAirItIsItsBase) {
  expect_same({"plastic", {{.kind = Kind::plastic, .base_color = cases::kPaint, .roughness = 0, .ior = 1}}},
              {"diffuse", {{.base_color = cases::kPaint}}}, 1e-4f);
}

Material gltf() {
  return {.kind = Kind::metallic_roughness, .base_color = cases::kPaint, .metallic = 0.3f, .roughness = 0.6f};
}

TEST(Gltf, AMetalIsSchlicksReflectionAlone) {
  Material m = gltf();
  m.metallic = 1;
  const Bsdf b = Painted(m).bsdf(direction_at(0.7f));
  ASSERT_EQ(b.lobes.size(), 1u);
  EXPECT_TRUE(one_lobe(b));
  EXPECT_FALSE(has_diffuse(b));
  EXPECT_EQ(b.lobes[0].f0, m.base_color);
  EXPECT_FLOAT_EQ(b.lobes[0].alpha, 0.36f);
}

TEST(Gltf, ADielectricReflectsByItsIndex) {
  Material m = gltf();
  m.metallic = 0;
  EXPECT_NEAR(Painted(m).bsdf({0, 0, 1}).lobes[0].f0.x, 0.04f, 1e-6f);
  m.ior = 2;
  EXPECT_NEAR(Painted(m).bsdf({0, 0, 1}).lobes[0].f0.x, 1.0f / 9, 1e-6f);
}

TEST(Gltf, LayersOfStrengthZeroAreNotThere) {
  Material m = gltf();
  m.clearcoat_roughness = 0.3f;
  m.sheen_roughness = 0.7f;
  m.thin = true;
  m.attenuation_distance = 1;
  expect_same({"", {gltf()}}, {"", {m}}, 0);
  EXPECT_EQ(Painted(m).bsdf({0, 0, 1}).lobes.size(), Painted(gltf()).bsdf({0, 0, 1}).lobes.size());
}

TEST(Gltf, AlmostNoCoatOrSheenIsAlmostAsWithout) {
  Material coated = gltf(), sheen = gltf(), clear = gltf();
  coated.clearcoat = 1e-5f;
  coated.clearcoat_roughness = 1;
  sheen.sheen_color = Color(1e-5f, 1e-5f, 1e-5f);
  sheen.sheen_roughness = 0.5f;
  clear.transmission = 1e-5f;
  for (const Material& m : {coated, sheen, clear}) expect_same({"", {gltf()}}, {"", {m}}, 2e-4f);
}

// A clear coat reflects by Schlick's term of an index of 1.5, and takes as much from what is below.
TEST(Gltf, AClearCoatReflectsAndDimsTheBase) {
  Material m{.kind = Kind::metallic_roughness, .base_color = Color(0.5f, 0.5f, 0.5f), .metallic = 0};
  const float base = evaluate(Painted(m).bsdf({0, 0, 1}), {0, 0, 1}).f().x;
  m.clearcoat = 1;
  m.clearcoat_roughness = 0.5f;
  const Bsdf b = Painted(m).bsdf({0, 0, 1});
  // D / (4 G) at the pole, where the masking is 1: 1 / (4 pi alpha^2).
  EXPECT_NEAR(evaluate(b, {0, 0, 1}).f().x, base * 0.96f + 0.04f / (4 * kPi * square(0.25f)), 1e-4f);
}

TEST(Gltf, ACoatHasItsOwnNormal) {
  Painted painted(gltf());
  Material& m = painted.material();
  m.clearcoat = 1;
  m.clearcoat_roughness = 0.1f;
  m.normal_texture = {.picture = painted.add_picture(1, 3, {0.8f, 0.5f, 0.9f})};
  const Bsdf flat = painted.bsdf({0, 0, 1});
  ASSERT_EQ(flat.facings.size(), 1u);
  EXPECT_LT(length(flat.frame.z - Vec3(0.6f, 0, 0.8f)), 1e-5f);
  EXPECT_LT(length(flat.facings[0].frame.z - Vec3(0, 0, 1)), 1e-5f);
  // The coat mirrors straight back, the base to the side.
  EXPECT_GT(evaluate(flat, {0, 0, 1}).specular.x, 20);
}

TEST(Gltf, SheenIsOfItsColourAndStrongestAtGrazing) {
  Material m{.kind = Kind::metallic_roughness, .base_color = Color(0, 0, 0), .metallic = 1};
  m.sheen_color = Color(1, 0.5f, 0);
  m.sheen_roughness = 0.5f;
  const Seen seen({"", {m}});
  const auto sheen_at = [&](float cosine) {
    return evaluate(seen.from(direction_at(cosine)), {0, 0, 1}).diffuse;
  };
  EXPECT_GT(sheen_at(0.2f).x, 3 * sheen_at(0.9f).x);
  EXPECT_NEAR(sheen_at(0.2f).y, 0.5f * sheen_at(0.2f).x, 1e-6f);
  EXPECT_EQ(sheen_at(0.2f).z, 0);
}

TEST(Gltf, TheTableOfSheenIsTheIntegralOfItsModel) {
  const SheenAlbedo table;
  for (const float roughness : {0.3f, 0.5f, 0.77f, 1.0f})
    for (const float cosine : {0.9f, 0.5f, 0.2f, 0.06f}) {
      const Vec3 wo = direction_at(cosine);
      const float integral = integral_over_directions(Square(), 300, [&](const Vec3& wi) {
        return wi.z > 0 ? raw_sheen_value(square(roughness), wo, wi) : 0.0f;
      });
      EXPECT_NEAR(table(cosine, square(roughness)), integral, 0.01f + 0.02f * integral)
          << roughness << " " << cosine;
    }
}

TEST(Gltf, TransmissionTakesTheDiffusePart) {
  Material m = gltf();
  m.metallic = 0;
  const float diffuse = evaluate(Painted(m).bsdf({0, 0, 1}), {0, 0, 1}).diffuse.x;
  for (const bool thin : {false, true}) {
    m.transmission = 0.75f;
    m.thin = thin;
    const Bsdf b = Painted(m).bsdf({0, 0, 1});
    EXPECT_NEAR(evaluate(b, {0, 0, 1}).diffuse.x, 0.25f * diffuse, 1e-5f);
    EXPECT_GT(evaluate(b, {0, 0, -1}).specular.x, 0);
    m.transmission = 1;
    EXPECT_FALSE(has_diffuse(Painted(m).bsdf({0, 0, 1})));
  }
}

// All of it through: the dielectric of KHR_materials_transmission is our glass.
TEST(Gltf, FullTransmissionIsGlass) {
  for (const bool thin : {false, true}) {
    Material m = gltf();
    m.metallic = 0;
    m.transmission = 1;
    m.thin = thin;
    m.attenuation_color = Color(0.5f, 0.6f, 0.7f);
    m.attenuation_distance = 3;
    Material glass = m;
    glass.kind = Kind::glass;
    expect_same({"", {m}}, {"", {glass}});
    EXPECT_EQ(Painted(m).bsdf({0, 0, 1}).absorption, Painted(glass).bsdf({0, 0, 1}).absorption);
    EXPECT_EQ(is_black(Painted(m).bsdf({0, 0, 1}).absorption), thin);
  }
}

TEST(Mix, IsTheConvexCombination) {
  const Material a = gltf(), b{.kind = Kind::glass, .roughness = 0.7f},
                 c{.kind = Kind::metal, .roughness = 0.5f};
  const Material inner{.kind = Kind::mix, .first = 0, .second = 1, .mix = 0.25f};
  const Material outer{.kind = Kind::mix, .first = 2, .second = 3, .mix = 0.6f};
  const Seen seen_a({"", {a}}), seen_b({"", {b}}), seen_c({"", {c}}), mixed({"", {a, b, c, inner, outer}});
  for (const Vec3& wo : directions())
    for (const Vec3& wi : directions()) {
      const Color expected = evaluate(seen_a.from(wo), wi).f() * (0.6f * 0.75f) +
                             evaluate(seen_b.from(wo), wi).f() * (0.6f * 0.25f) +
                             evaluate(seen_c.from(wo), wi).f() * 0.4f;
      const Color found = evaluate(mixed.from(wo), wi).f();
      for (int k = 0; k < 3; ++k) EXPECT_NEAR(found[k], expected[k], 1e-5f * (1 + expected[k]));
    }
}

TEST(Mix, AllOfOneIsThatOne) {
  const Material a = gltf(), b{.kind = Kind::metal, .roughness = 0.5f};
  const auto mixed = [&](float share) {
    return BsdfCase{"", {a, b, {.kind = Kind::mix, .first = 0, .second = 1, .mix = share}}};
  };
  expect_same(mixed(0), {"", {a}}, 0);
  expect_same(mixed(1), {"", {b}}, 0);
}

TEST(Mix, OfMirrorsAndPaintSendsEachItsShare) {
  const Material paint{.base_color = Color(1, 1, 1)},
      mirror{.kind = Kind::mirror, .base_color = Color(1, 1, 1)};
  const Bsdf b = Seen({"", {paint, mirror, {.kind = Kind::mix, .first = 0, .second = 1, .mix = 0.3f}}})
                     .from(direction_at(0.5f));
  EXPECT_FALSE(b.delta);
  const Energy e = energy(b, 20000);
  EXPECT_NEAR(e.mean.x, 1, 4 * e.error + 1e-4f);
  EXPECT_NEAR(evaluate(b, {0, 0, 1}).f().x, 0.7f * kInvPi, 1e-6f);
}

TEST(Mix, OfTheMostLeavesWithAllTheirLobesHasRoomForAll) {
  std::vector<Material> all;
  for (int i = 0; i < 8; ++i) {
    Material m = gltf();
    m.transmission = 0.5f;
    m.clearcoat = 0.5f;
    m.sheen_color = Color(0.1f, 0.1f, 0.1f);
    all.push_back(m);
  }
  for (int i = 0; i < 7; ++i) all.push_back({.kind = Kind::mix, .first = 2 * i, .second = 2 * i + 1});
  const Seen seen({"", all});
  const Bsdf b = seen.from(direction_at(0.5f));
  EXPECT_EQ(b.lobes.size(), kMaxLobes);
  EXPECT_EQ(b.layers.size(), 16u);
  const Seen one({"", {all[0]}});
  const Vec3 wi = direction_at(0.8f);
  EXPECT_NEAR(evaluate(b, wi).f().x, evaluate(one.from(direction_at(0.5f)), wi).f().x, 1e-4f);
}

TEST(Unlit, ScattersNothing) {
  const Bsdf b = Painted({.kind = Kind::unlit, .base_color = Color(1, 1, 1)}).bsdf(direction_at(0.5f));
  EXPECT_TRUE(b.delta);
  EXPECT_TRUE(is_black(sample(b, 0.5f, {0.5f, 0.5f}).weight()));
  EXPECT_TRUE(is_black(evaluate(b, {0, 0, 1}).f()));
  EXPECT_TRUE(is_black(albedo(b)));
}

}  // namespace
}  // namespace tessera::tracer
