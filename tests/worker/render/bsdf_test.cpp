// SPDX-License-Identifier: Apache-2.0
// What holds for the scattering of every material, at every incidence, from both sides.
#include "worker/render/bsdf/bsdf.h"

#include "tests/worker/render/bsdf_cases.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;

constexpr float kCosines[] = {0.98f, 0.6f, 0.2f, -0.7f};

// Calls check(case, seen, wo) for all of them.
template <typename Check>
void for_all(const Check& check) {
  for (const BsdfCase& c : cases::every()) {
    const Seen seen(c);
    for (const float cosine : kCosines) {
      SCOPED_TRACE(c.name + " at " + std::to_string(cosine));
      check(c, seen, direction_at(cosine));
    }
  }
}

// Some 150 tests, each of which fails one time in a million.
TEST(Bsdf, SamplesFollowTheirDensity) {
  for_all([](const BsdfCase& c, const Seen& seen, const Vec3& wo) {
    const Bsdf b = seen.from(wo);
    const Square square = square_for(c, wo);
    Random random(11);
    std::vector<Vec2> points;
    constexpr int kTries = 30000;
    for (int i = 0; i < kTries; ++i) {
      const float lobe = random.number();
      const BsdfSample s = sample(b, lobe, random.pair());
      if (s.pdf > 0) points.push_back(square.point(s.wi));
    }
    const Density density = [&](double x, double y) {
      return evaluate(b, square.direction(x, y)).pdf * square.size(y);
    };
    expect_follows(points, kTries, density, c.name.c_str(), 16, 14);
  });
}

TEST(Bsdf, TheMeanWeightIsTheIntegralOfWhatIsScattered) {
  for_all([](const BsdfCase& c, const Seen& seen, const Vec3& wo) {
    const Bsdf b = seen.from(wo);
    Random random(12);
    double sum = 0, squares = 0;
    constexpr int kTries = 20000;
    for (int i = 0; i < kTries; ++i) {
      const float lobe = random.number();
      const BsdfSample s = sample(b, lobe, random.pair());
      const double w = s.pdf > 0 ? s.weight().x + s.weight().y : 0.0f;
      sum += w, squares += w * w;
    }
    const double mean = sum / kTries;
    const double error = std::sqrt((squares / kTries - mean * mean) / kTries);
    const double integral = integral_over_directions(square_for(c, wo), 200, [&](const Vec3& wi) {
      const Color f = evaluate(b, wi).f();
      return f.x + f.y;
    });
    EXPECT_NEAR(mean, integral, 5 * error + 4e-3 * integral);
  });
}

TEST(Bsdf, ASampleCarriesItsValueOverItsDensity) {
  for_all([](const BsdfCase&, const Seen& seen, const Vec3& wo) {
    const Bsdf b = seen.from(wo);
    Random random(5);
    for (int i = 0; i < 500; ++i) {
      const float lobe = random.number();
      const BsdfSample s = sample(b, lobe, random.pair());
      if (!(s.pdf > 0)) continue;
      const BsdfValue v = evaluate(b, s.wi);
      ASSERT_NEAR(v.pdf, s.pdf, 1e-3f * s.pdf);
      for (int k = 0; k < 3; ++k) {
        ASSERT_NEAR(s.diffuse[k] * s.pdf, v.diffuse[k], 2e-3f * v.f()[k] + 1e-6f);
        ASSERT_NEAR(s.specular[k] * s.pdf, v.specular[k], 2e-3f * v.f()[k] + 1e-6f);
      }
    }
  });
}

// f / n^2 of the side seen from is the same from both ends; Veach 1997, eq. 5.14.
TEST(Bsdf, ScatteringIsReciprocal) {
  Random random(3);
  for (const BsdfCase& c : cases::every()) {
    const Seen seen(c);
    int both = 0;
    for (int i = 0; i < 600; ++i) {
      const Vec2 u = random.pair(), v = random.pair();
      const Vec3 wo = from_square(u.x, 0.02 + 0.96 * u.y), wi = from_square(v.x, 0.02 + 0.96 * v.y);
      const bool crosses = wo.z * wi.z < 0 && !c.materials.back().thin;
      const bool bends = crosses && c.name.find("translucent") == std::string::npos;
      const float index2 = bends ? 1.5f * 1.5f : 1.0f;
      const Color a = evaluate(seen.from(wo), wi).f() * std::abs(wo.z) * (wo.z < 0 ? 1 / index2 : 1.0f);
      const Color b = evaluate(seen.from(wi), wo).f() * std::abs(wi.z) * (wi.z < 0 ? 1 / index2 : 1.0f);
      both += max_component(a) > 0 && max_component(b) > 0;
      for (int k = 0; k < 3; ++k) ASSERT_NEAR(a[k], b[k], 2e-3f * a[k] + 1e-5f) << c.name << wo << wi;
    }
    EXPECT_GT(both, 50) << c.name;
  }
}

// The bound of the excess: a rough boundary's mean Fresnel reflectance differs from the smooth one's, by
// which the layers below are weighed, by less than 1e-3.
TEST(Bsdf, NoMoreLightLeavesThanComes) {
  for (BsdfCase c : cases::every()) {
    for (Material& m : c.materials) {
      const bool translucent = m.kind == Material::Kind::translucent;
      m.base_color = translucent ? Color(1, 1, 1) - m.transmission_color : Color(1, 1, 1);
      m.sheen_color = is_black(m.sheen_color) ? m.sheen_color : Color(1, 1, 1);
    }
    const Seen seen(c);
    for (const float cosine : {0.98f, 0.6f, 0.2f, 0.05f, -0.7f, -0.3f}) {
      const Energy e = energy(seen.from(direction_at(cosine)), 10000);
      EXPECT_LE(max_component(e.mean), 1 + 4.5f * e.error + 1e-3f) << c.name << " at " << cosine;
    }
  }
}

TEST(Bsdf, NothingGoesThroughWhatIsOpaqueOrBetweenTheNormals) {
  for (const BsdfCase& c : cases::every()) {
    Bsdf b = Seen(c).from(direction_at(0.5f));
    if (b.sheen) continue;          // borrowed from what is gone
    b.ng = unit(Vec3(0.5f, 0, 1));  // a shading normal that is not the geometric one
    Random random(1);
    for (int i = 0; i < 1000; ++i) {
      const float lobe = random.number();
      const BsdfSample s = sample(b, lobe, random.pair());
      ASSERT_TRUE(is_black(s.weight()) || s.wi.z * dot(s.wi, b.ng) > 0) << c.name;
    }
    EXPECT_TRUE(is_black(evaluate(b, unit(Vec3(-1, 0, 0.3f))).f())) << c.name;
    EXPECT_TRUE(is_black(evaluate(b, unit(Vec3(1, 0, -0.3f))).f())) << c.name;
  }
  for (const auto& family : {cases::metal(), cases::plastic()})
    for (const BsdfCase& c : family) {
      const Bsdf b = Seen(c).from(direction_at(0.5f));
      EXPECT_TRUE(is_black(evaluate(b, {0, 0, -1}).f())) << c.name;
      EXPECT_EQ(evaluate(b, {0, 0, -1}).pdf, 0) << c.name;
    }
}

TEST(Bsdf, TheAlbedoIsTheLightThatIsScatteredOrMoreWhereFacetsShadow) {
  for_all([](const BsdfCase&, const Seen& seen, const Vec3& wo) {
    const Bsdf b = seen.from(wo);
    const Energy e = energy(b, 4000);
    bool shadowed = false, wide = false;
    for (const Lobe& l : b.lobes) {
      shadowed |= !is_diffuse(l) && l.alpha > 0.05f;
      wide |= l.kind == Lobe::Kind::phong && l.alpha < 10;
    }
    for (int k = 0; k < 3; ++k) {
      EXPECT_GE(albedo(b)[k], e.mean[k] - 5 * e.error - (wide ? 0.2f : 0.03f));
      EXPECT_LE(albedo(b)[k], shadowed ? 1.001f : e.mean[k] + 5 * e.error + 0.03f);
    }
  });
}

TEST(Bsdf, SharesOfLobesAddUpAndNoneIsForgotten) {
  for_all([](const BsdfCase&, const Seen& seen, const Vec3& wo) {
    const Bsdf b = seen.from(wo);
    float sum = 0;
    for (const Lobe& l : b.lobes) {
      EXPECT_GE(l.share, 0.4f / float(b.lobes.size()) * 0.5f);
      sum += l.share;
    }
    EXPECT_NEAR(sum, 1, 1e-5f);
  });
}

TEST(Bsdf, RegularisingLeavesNoMirrorAndNoLobeNarrowerThanAsked) {
  const auto regular = [](Material m) {
    Bsdf b = Painted(std::move(m)).bsdf(direction_at(0.8f));
    regularise(b, 0.3f);
    return b;
  };
  using Kind = Material::Kind;
  for (const Material& m :
       {Material{.kind = Kind::mirror}, Material{.kind = Kind::glass, .roughness = 0},
        Material{.kind = Kind::glass, .roughness = 0, .thin = true},
        Material{.kind = Kind::metal, .roughness = 0}, Material{.kind = Kind::metal, .roughness = 0.4f}}) {
    const Bsdf b = regular(m);
    EXPECT_FALSE(b.delta);
    EXPECT_FLOAT_EQ(b.lobes[0].alpha, 0.3f);
  }
  EXPECT_FLOAT_EQ(regular({.kind = Kind::metal, .roughness = 0.9f}).lobes[0].alpha, 0.81f);
  EXPECT_FLOAT_EQ(regular({.kind = Kind::metal, .exponent = 5}).lobes[0].alpha, 5);
  EXPECT_FLOAT_EQ(regular({.kind = Kind::metal, .exponent = 900}).lobes[0].alpha, 2 / 0.09f - 2);
  // Without a difference of indices facets bend nothing, however rough they are.
  EXPECT_TRUE(regular({.kind = Kind::glass, .roughness = 0, .ior = 1}).delta);
}

}  // namespace
}  // namespace tessera::tracer
