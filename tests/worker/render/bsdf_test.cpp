// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bsdf/bsdf.h"

#include "tests/worker/render/chi_squared.h"
#include "worker/render/bsdf/fresnel.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

// Frames are world axes, so local and world agree.
Bsdf seen_from(Bsdf b, float cosine) {
  b.frame.x = {1, 0, 0};
  b.frame.y = {0, 1, 0};
  b.frame.z = b.ng = {0, 0, 1};
  b.wo = {std::sqrt(1 - cosine * cosine) * 0.8f, std::sqrt(1 - cosine * cosine) * 0.6f, cosine};
  return b;
}

struct Case {
  const char* name;
  Bsdf bsdf;
};
std::vector<Case> rough_cases() {
  const auto glossy = [](float alpha, float share) {
    Bsdf b{.kind = Material::Kind::metallic_roughness,
           .color = Color(0.7f, 0.5f, 0.2f),
           .f0 = Color(0.04f, 0.1f, 0.3f)};
    b.alpha = alpha;
    b.specular_share = share;
    return b;
  };
  const auto metal = [](float alpha) {
    Bsdf b{.kind = Material::Kind::metal,
           .color = Color(1, 1, 1),
           .eta = Color(0.2f, 0.92f, 1.1f),
           .k = Color(3.9f, 2.45f, 2.14f)};
    b.alpha = alpha;
    return b;
  };
  const auto only = [](Bsdf b) {
    b.color = Color(0, 0, 0);
    return b;
  };
  return {{"diffuse", {.kind = Material::Kind::diffuse, .color = Color(0.8f, 0.5f, 0.1f)}},
          {"metal 0.2", metal(0.2f)},
          {"metal 0.5", metal(0.5f)},
          {"metal 1", metal(1)},
          {"glossy 0.3", glossy(0.3f, 0.4f)},
          {"glossy 1", glossy(1, 0.7f)},
          {"specular only", only(glossy(0.4f, 1))}};
}

constexpr float kCosines[] = {0.98f, 0.6f, 0.2f};

TEST(Bsdf, SamplesFollowTheirDensity) {
  for (const Case& c : rough_cases())
    for (const float cosine : kCosines) {
      const Bsdf b = seen_from(c.bsdf, cosine);
      Random random(11);
      std::vector<Vec2> points;
      constexpr int kTries = 100000;
      for (int i = 0; i < kTries; ++i) {
        const float lobe = random.number();
        const BsdfSample s = sample(b, lobe, random.pair());
        if (s.pdf > 0) points.push_back(on_square(s.wi));
      }
      expect_follows(points, kTries, on_sphere([&](const Vec3& d) { return evaluate(b, d).pdf; }), c.name);
    }
}

TEST(Bsdf, ASampleCarriesItsValueOverItsDensity) {
  for (const Case& c : rough_cases())
    for (const float cosine : kCosines) {
      const Bsdf b = seen_from(c.bsdf, cosine);
      Random random(5);
      for (int i = 0; i < 1000; ++i) {
        const BsdfSample s = sample(b, random.number(), random.pair());
        if (!(s.pdf > 0)) continue;
        const BsdfValue v = evaluate(b, s.wi);
        ASSERT_NEAR(v.pdf, s.pdf, 1e-3f * s.pdf) << c.name;
        for (int k = 0; k < 3; ++k)
          ASSERT_NEAR(s.weight()[k] * s.pdf, v.f()[k], 2e-3f * v.f()[k] + 1e-6f) << c.name;
      }
    }
}

TEST(Bsdf, ScatteringIsReciprocal) {
  Random random(3);
  for (const Case& c : rough_cases())
    for (int i = 0; i < 1000; ++i) {
      const Vec2 u = random.pair(), v = random.pair();
      Bsdf there = seen_from(c.bsdf, 1);
      there.wo = from_square(u.x, 0.51 + 0.48 * u.y);
      Bsdf back = there;
      const Vec3 wi = from_square(v.x, 0.51 + 0.48 * v.y);
      back.wo = wi;
      const Color a = evaluate(there, wi).f() * there.wo.z, b = evaluate(back, there.wo).f() * wi.z;
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(a[k], b[k], 1e-4f * a[k] + 1e-6f) << c.name;
    }
}

TEST(Bsdf, NoMoreLightLeavesThanComes) {
  for (const Case& c : rough_cases())
    for (const float cosine : kCosines) {
      Bsdf b = seen_from(c.bsdf, cosine);
      if (b.specular_share < 1) b.color = Color(1, 1, 1);
      Random random(9);
      Color sum(0, 0, 0);
      constexpr int kTries = 20000;
      for (int i = 0; i < kTries; ++i) {
        const float lobe = random.number();
        sum += sample(b, lobe, random.pair()).weight();
      }
      // Weights lie in 0..3 or so: a standard error of the mean of 3 / sqrt(n) at the very most.
      EXPECT_LE(max_component(sum) / kTries, 1 + 3 / std::sqrt(float(kTries))) << c.name << " at " << cosine;
    }
}

TEST(Bsdf, NothingIsScatteredThroughTheSurfaceOrBelowTheGeometry) {
  for (const Case& c : rough_cases()) {
    Bsdf b = seen_from(c.bsdf, 0.5f);
    b.ng = unit(Vec3(0.5f, 0, 1));  // a shading normal that is not the geometric one
    Random random(1);
    for (int i = 0; i < 2000; ++i) {
      const float lobe = random.number();
      const BsdfSample s = sample(b, lobe, random.pair());
      ASSERT_TRUE(is_black(s.weight()) || (s.wi.z > 0 && dot(s.wi, b.ng) > 0)) << c.name;
    }
    EXPECT_TRUE(is_black(evaluate(b, {0, 0, -1}).f())) << c.name;
    EXPECT_TRUE(is_black(evaluate(b, unit(Vec3(-1, 0, 0.3f))).f())) << c.name;
  }
}

TEST(Bsdf, AMirrorReflectsAllItsColour) {
  const Bsdf b =
      seen_from({.kind = Material::Kind::mirror, .delta = true, .color = Color(0.9f, 0.5f, 0.1f)}, 0.6f);
  const BsdfSample s = sample(b, 0.5f, {0.1f, 0.2f});
  EXPECT_EQ(s.pdf, 0);
  EXPECT_EQ(s.weight(), b.color);
  EXPECT_LT(length(s.wi - Vec3(-b.wo.x, -b.wo.y, b.wo.z)), 1e-6f);
}

TEST(Bsdf, GlassSplitsLightByFresnelAndBendsItBySnell) {
  for (const float ior : {1.5f, 1 / 1.5f}) {
    const Bsdf b = seen_from(
        {.kind = Material::Kind::glass, .delta = true, .color = Color(1, 0.5f, 0.25f), .ior = ior}, 0.8f);
    const float r = dielectric_fresnel(0.8f, ior).reflectance;
    EXPECT_GT(sample(b, r * 0.999f, {}).wi.z, 0);
    const BsdfSample through = sample(b, r * 1.001f, {});
    EXPECT_LT(through.wi.z, 0);
    EXPECT_NEAR(std::hypot(through.wi.x, through.wi.y) * ior, 0.6f, 1e-5f);
    EXPECT_NEAR(length(through.wi), 1, 1e-5f);
    EXPECT_NEAR(through.weight().y, 0.5f / (ior * ior), 1e-5f);
    EXPECT_NEAR(through.radiance_scale, 1 / (ior * ior), 1e-5f);
  }
  // Beyond the critical angle all is reflected.
  const Bsdf inside = seen_from({.kind = Material::Kind::glass, .delta = true, .ior = 1 / 1.5f}, 0.3f);
  EXPECT_GT(sample(inside, 0.999999f, {}).wi.z, 0);
}

TEST(Fresnel, ADielectricReflectsAsAtNormalIncidenceAtBrewstersAngleAndGrazing) {
  const float n = 1.5f;
  EXPECT_NEAR(dielectric_fresnel(1, n).reflectance, 0.04f, 1e-6f);
  // At Brewster's angle only the perpendicular part is reflected: ((n^2 - 1) / (n^2 + 1))^2 of its half.
  const float brewster = std::cos(std::atan(n));
  EXPECT_NEAR(dielectric_fresnel(brewster, n).reflectance, 0.5f * square((n * n - 1) / (n * n + 1)), 1e-6f);
  EXPECT_NEAR(dielectric_fresnel(1e-6f, n).reflectance, 1, 1e-4f);
  EXPECT_EQ(dielectric_fresnel(0.5f, 0.5f).reflectance, 1);
}

TEST(Fresnel, AConductorAtNormalIncidenceAndWithoutExtinctionIsKnown) {
  EXPECT_NEAR(conductor_fresnel(1, 0.2f, 3.9f), (square(0.8f) + square(3.9f)) / (square(1.2f) + square(3.9f)),
              1e-6f);
  for (const float cosine : {1.0f, 0.7f, 0.3f, 0.05f})
    EXPECT_NEAR(conductor_fresnel(cosine, 1.5f, 0), dielectric_fresnel(cosine, 1.5f).reflectance, 1e-5f);
}

}  // namespace
}  // namespace tessera::tracer
