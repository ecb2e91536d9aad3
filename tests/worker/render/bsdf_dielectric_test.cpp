// SPDX-License-Identifier: Apache-2.0
// Fresnel's equations, mirrors, glass and sheets.
#include "tests/worker/render/bsdf_cases.h"
#include "worker/render/bsdf/dielectric.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Kind = Material::Kind;

TEST(Fresnel, ADielectricReflectsAsAtNormalIncidenceAtBrewstersAngleAndGrazing) {
  const float n = 1.5f;
  EXPECT_NEAR(dielectric_fresnel(1, n).reflectance, 0.04f, 1e-6f);
  // At Brewster's angle only the perpendicular part is reflected: ((n^2 - 1) / (n^2 + 1))^2 of its half.
  const float brewster = std::cos(std::atan(n));
  EXPECT_NEAR(dielectric_fresnel(brewster, n).reflectance, 0.5f * square((n * n - 1) / (n * n + 1)), 1e-6f);
  EXPECT_NEAR(dielectric_fresnel(1e-6f, n).reflectance, 1, 1e-4f);
  EXPECT_EQ(dielectric_fresnel(0.5f, 0.5f).reflectance, 1);
  EXPECT_NEAR(dielectric_fresnel(0.3f, 1).reflectance, 0, 1e-6f);
}

TEST(Fresnel, TotalReflectionBeginsAtTheCriticalAngle) {
  const float critical = std::sqrt(1 - 1 / square(1.5f));
  EXPECT_EQ(dielectric_fresnel(critical * 0.999f, 1 / 1.5f).reflectance, 1);
  EXPECT_LT(dielectric_fresnel(critical * 1.001f, 1 / 1.5f).reflectance, 0.95f);
}

TEST(Fresnel, ABoundaryReflectsTheSameFromBothSidesAlongOneRefractedPath) {
  for (const float cosine : {1.0f, 0.7f, 0.4f, 0.1f}) {
    const DielectricBoundary in = dielectric_fresnel(cosine, 1.7f);
    EXPECT_NEAR(dielectric_fresnel(in.cos_refracted, 1 / 1.7f).reflectance, in.reflectance, 1e-5f);
  }
}

TEST(Fresnel, AConductorAtNormalIncidenceAndWithoutExtinctionIsKnown) {
  EXPECT_NEAR(conductor_fresnel(1, 0.2f, 3.9f), (square(0.8f) + square(3.9f)) / (square(1.2f) + square(3.9f)),
              1e-6f);
  for (const float cosine : {1.0f, 0.7f, 0.3f, 0.05f})
    EXPECT_NEAR(conductor_fresnel(cosine, 1.5f, 0), dielectric_fresnel(cosine, 1.5f).reflectance, 1e-5f);
  for (const float cosine : {1.0f, 0.5f, 0.1f}) EXPECT_NEAR(conductor_fresnel(cosine, 1, 1e5f), 1, 1e-4f);
}

// Walsh's closed form of 1926 for the reflectance of diffuse light.
TEST(Fresnel, TheMeanReflectanceIsThatOfWalsh) {
  for (const double n : {1.2, 1.5, 2.0, 4.0}) {
    const double n2 = n * n, n4 = n2 * n2;
    const double walsh = 0.5 + (n - 1) * (3 * n + 1) / (6 * (n + 1) * (n + 1)) +
                         n2 * (n2 - 1) * (n2 - 1) / std::pow(n2 + 1, 3) * std::log((n - 1) / (n + 1)) -
                         2 * n2 * n * (n2 + 2 * n - 1) / ((n2 + 1) * (n4 - 1)) +
                         8 * n4 * (n4 + 1) / ((n2 + 1) * (n4 - 1) * (n4 - 1)) * std::log(n);
    EXPECT_NEAR(mean_dielectric_fresnel(float(n)), walsh, 1e-4);
  }
  EXPECT_NEAR(mean_dielectric_fresnel(1), 0, 1e-5f);
}

Bsdf seen_from(const Material& m, float cosine) { return Painted(m).bsdf(direction_at(cosine)); }

TEST(Mirror, ReflectsAllItsColour) {
  const Bsdf b = seen_from({.kind = Kind::mirror, .base_color = Color(0.9f, 0.5f, 0.1f)}, 0.6f);
  const BsdfSample s = sample(b, 0.5f, {0.1f, 0.2f});
  EXPECT_TRUE(b.delta && one_lobe(b));
  EXPECT_EQ(s.pdf, 0);
  EXPECT_EQ(s.weight(), Color(0.9f, 0.5f, 0.1f));
  EXPECT_LT(length(s.wi - direction_at(0.6f) * Vec3(-1, -1, 1)), 1e-6f);
}

TEST(Metal, SmoothItReflectsByFresnelAndAllOfItIfItConductsPerfectly) {
  Material m{.kind = Kind::metal, .base_color = Color(1, 0.5f, 1), .roughness = 0};
  const Bsdf b = seen_from(m, 0.4f);
  EXPECT_TRUE(b.delta);
  EXPECT_LT(length(sample(b, 0, {}).weight() - m.base_color * conductor_fresnel(0.4f, m.eta, m.k)), 1e-5f);
  m.base_color = Color(1, 1, 1);
  m.k = Color(1e5f, 1e5f, 1e5f);
  for (const float cosine : {0.9f, 0.2f})
    EXPECT_NEAR(sample(seen_from(m, cosine), 0, {}).weight().x, 1, 1e-4f);
}

// Lafortune and Willems 1994: at normal incidence the lobe (n + 2) / (2 pi) cos^n reflects all.
TEST(Metal, ACosineLobeReflectsAllAtNormalIncidence) {
  for (const float exponent : {0.5f, 10.0f, 3000.0f}) {
    Material m{.kind = Kind::metal, .base_color = Color(1, 1, 1), .exponent = exponent};
    m.k = Color(1e6f, 1e6f, 1e6f);
    const Energy e = energy(seen_from(m, 1), 20000);
    EXPECT_NEAR(e.mean.x, 1, 4 * e.error + 1e-3f) << exponent;
  }
}

TEST(Metal, AWideExponentsLobeIsAsNarrowAsItSays) {
  // The mean versine of density (n + 1) / (2 pi) cos^n is 1 / (n + 2).
  for (const float exponent : {100.0f, 1e6f}) {
    const Bsdf b = seen_from({.kind = Kind::metal, .exponent = exponent}, 0.8f);
    Random random(2);
    double sum = 0;
    constexpr int kTries = 20000;
    for (int i = 0; i < kTries; ++i) {
      const Vec3 chord = sample(b, 0, random.pair()).wi - direction_at(0.8f) * Vec3(-1, -1, 1);
      sum += 0.5 * dot(chord, chord);
    }
    EXPECT_NEAR(sum / kTries * (exponent + 2), 1, 5 / std::sqrt(double(kTries)) + 2e-3) << exponent;
  }
}

TEST(Glass, SplitsLightByFresnelAndBendsItBySnell) {
  const Material m{.kind = Kind::glass, .base_color = Color(1, 0.5f, 0.25f), .roughness = 0, .ior = 1.5f};
  for (const float side : {1.0f, -1.0f}) {
    const float ior = side > 0 ? 1.5f : 1 / 1.5f;
    const Bsdf b = seen_from(m, side * 0.8f);
    EXPECT_TRUE(b.delta);
    EXPECT_FALSE(one_lobe(b));
    const float r = dielectric_fresnel(0.8f, ior).reflectance;
    const BsdfSample back = sample(b, r * 0.999f, {});
    EXPECT_GT(back.wi.z * side, 0);
    EXPECT_FALSE(back.crossed);
    EXPECT_EQ(back.weight(), Color(1, 1, 1));
    const BsdfSample through = sample(b, r * 1.001f, {});
    EXPECT_LT(through.wi.z * side, 0);
    EXPECT_TRUE(through.crossed);
    EXPECT_NEAR(std::hypot(through.wi.x, through.wi.y) * ior, 0.6f, 1e-5f);
    EXPECT_NEAR(length(through.wi), 1, 1e-5f);
    EXPECT_NEAR(through.weight().y, 0.5f / (ior * ior), 1e-5f);
    EXPECT_NEAR(through.radiance_scale, 1 / (ior * ior), 1e-5f);
  }
  // Beyond the critical angle all is reflected.
  EXPECT_LT(sample(seen_from(m, -0.3f), 0.999999f, {}).wi.z, 0);
}

TEST(Glass, ASheetLetsLightThroughUnbentAndReflectsTheSeriesOfItsTwoSides) {
  const Material m{
      .kind = Kind::glass, .base_color = Color(1, 0.5f, 1), .roughness = 0, .ior = 1.5f, .thin = true};
  for (const float cosine : {0.9f, 0.3f, -0.5f}) {
    const Bsdf b = seen_from(m, cosine);
    const float r = dielectric_fresnel(std::abs(cosine), 1.5f).reflectance;
    float reflected = r, within = square(1 - r);  // what enters is reflected 1, 3, 5, ... times and leaves
    for (int i = 0; i < 50; ++i) reflected += within * std::pow(r, 1 + 2.0f * float(i));
    EXPECT_GT(sample(b, reflected * 0.999f, {}).wi.z * cosine, 0);
    const BsdfSample through = sample(b, reflected * 1.001f, {});
    EXPECT_LT(length(through.wi + direction_at(cosine)), 1e-6f);
    EXPECT_FALSE(through.crossed);
    EXPECT_EQ(through.radiance_scale, 1);
    EXPECT_EQ(through.weight(), m.base_color);
  }
}

TEST(Glass, SmoothGlassSheetsAndMirrorsLoseNothing) {
  for (const Material& m :
       {Material{.kind = Kind::glass, .base_color = Color(1, 1, 1), .roughness = 0},
        Material{.kind = Kind::glass, .base_color = Color(1, 1, 1), .roughness = 0, .thin = true},
        Material{.kind = Kind::mirror, .base_color = Color(1, 1, 1)}})
    for (const float cosine : {0.98f, 0.3f, 0.05f, -0.9f, -0.2f}) {
      const Energy e = energy(seen_from(m, cosine), 1000);
      EXPECT_NEAR(e.mean.x, 1, 1e-5f) << int(m.kind) << " " << m.thin << " " << cosine;
    }
}

// Single scattering at a rough boundary loses what facets shadow, little where they are nearly smooth,
// whichever way it goes, and what is left is less for rougher glass.
TEST(Glass, RoughGlassLosesOnlyWhatItsFacetsShadow) {
  for (const float cosine : {0.95f, 0.5f, -0.95f}) {
    float before = 1 + 1e-3f;
    for (const float roughness : {0.1f, 0.4f, 0.7f, 1.0f}) {
      const Material m{.kind = Kind::glass, .base_color = Color(1, 1, 1), .roughness = roughness};
      const Energy e = energy(seen_from(m, cosine), 20000);
      EXPECT_LE(e.mean.x, before + 4 * e.error) << roughness << " " << cosine;
      before = e.mean.x;
      EXPECT_GT(e.mean.x, roughness < 0.2f ? 0.99f : 0.4f);
    }
  }
}

// As the facets become smooth, the rough boundary becomes the smooth one.
TEST(Glass, RoughGlassTendsToSmoothGlass) {
  for (const float cosine : {0.9f, 0.4f, -0.9f, -0.8f}) {
    const Bsdf rough = seen_from({.kind = Kind::glass, .roughness = 0.06f}, cosine);
    const Bsdf smooth = seen_from({.kind = Kind::glass, .roughness = 0}, cosine);
    EXPECT_FALSE(rough.delta);
    Random random(6);
    int reflected = 0;
    constexpr int kTries = 10000;
    for (int i = 0; i < kTries; ++i) {
      const float choice = random.number();
      const BsdfSample s = sample(rough, choice, random.pair()),
                       t = sample(smooth, s.crossed ? 0.9999f : 0, {});
      ASSERT_EQ(s.crossed, t.crossed);
      ASSERT_LT(length(s.wi - t.wi), 0.35f);
      reflected += !s.crossed;
    }
    const float r = dielectric_fresnel(std::abs(cosine), cosine > 0 ? 1.5f : 1 / 1.5f).reflectance;
    EXPECT_NEAR(float(reflected) / kTries, r, 0.02f);
  }
}

TEST(Glass, WithTheIndexOfAirItIsNotThere) {
  for (const float roughness : {0.0f, 0.5f, 1.0f}) {
    const Bsdf b = seen_from(
        {.kind = Kind::glass, .base_color = Color(1, 1, 1), .roughness = roughness, .ior = 1}, 0.4f);
    const BsdfSample s = sample(b, 0.5f, {0.3f, 0.7f});
    EXPECT_LT(length(s.wi + direction_at(0.4f)), 1e-5f);
    EXPECT_EQ(s.weight(), Color(1, 1, 1));
  }
}

TEST(Glass, AbsorbsByBeersLawWhereItHasAnInside) {
  Material m{.kind = Kind::glass, .roughness = 0};
  EXPECT_EQ(seen_from(m, 0.5f).absorption, Color(0, 0, 0));
  m.attenuation_color = Color(0.5f, 1, 0.1f);
  m.attenuation_distance = 0.2f;
  for (const float cosine : {0.5f, -0.5f}) {
    const Color a = seen_from(m, cosine).absorption;
    for (int k = 0; k < 3; ++k) EXPECT_NEAR(std::exp(-a[k] * 0.2f), m.attenuation_color[k], 1e-6f);
  }
  m.attenuation_color = Color(0, 0, 0);
  EXPECT_TRUE(std::isfinite(seen_from(m, 0.5f).absorption.x));
  EXPECT_EQ(std::exp(-seen_from(m, 0.5f).absorption.x), 0);
  m.thin = true;
  EXPECT_EQ(seen_from(m, 0.5f).absorption, Color(0, 0, 0));
}

}  // namespace
}  // namespace tessera::tracer
