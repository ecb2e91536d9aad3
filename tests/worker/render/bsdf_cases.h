// SPDX-License-Identifier: Apache-2.0
// Materials of every kind, and what must hold for the scattering of each of them.
#pragma once

#include <memory>
#include <string>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/painted.h"
#include "worker/render/bsdf/bsdf.h"

namespace tessera::testing {

using tracer::Bsdf;

struct BsdfCase {
  std::string name;
  std::vector<Material> materials;  // the last is looked at
  bool narrow = false;              // most of it is about the mirror direction
};

// A material whose Bsdfs can be had from any direction; world axes are the frame's, z up, or (x, -y, -z) from
// below.
class Seen {
 public:
  explicit Seen(const BsdfCase& c)
      : painted_(std::make_unique<Painted>(c.materials)),
        geometry_(painted_->scene),
        materials_(painted_->scene) {}

  Bsdf from(const Vec3& wo) const {
    const tracer::Hit hit{0, 0, 0.3f, 0.3f};
    return materials_.bsdf(geometry_, hit, geometry_.surface(hit, wo, -wo, 1), -wo);
  }

 private:
  std::unique_ptr<Painted> painted_;
  tracer::Geometry geometry_;
  tracer::Materials materials_;
};

inline Vec3 direction_at(float cosine) {
  const float sine = std::sqrt(1 - cosine * cosine);
  return {sine * 0.8f, sine * 0.6f, cosine};
}

inline std::vector<BsdfCase> with_roughness(const std::string& name, Material m,
                                            std::initializer_list<float> all) {
  std::vector<BsdfCase> cases;
  for (const float roughness : all) {
    m.roughness = roughness;
    cases.push_back({name + " of roughness " + std::to_string(roughness), {m}, roughness < 0.5f});
  }
  return cases;
}

namespace cases {

using Kind = Material::Kind;
inline const Color kPaint(0.7f, 0.5f, 0.2f);

inline std::vector<BsdfCase> diffuse() {
  return {{"diffuse", {{.kind = Kind::diffuse, .base_color = kPaint}}},
          {"translucent",
           {{.kind = Kind::translucent,
             .base_color = Color(0.3f, 0.2f, 0.1f),
             .transmission_color = Color(0.2f, 0.6f, 0.4f)}}}};
}

inline std::vector<BsdfCase> metal() {
  auto all = with_roughness("metal", {.kind = Kind::metal, .base_color = Color(1, 1, 1)}, {0.3f, 0.7f, 1.0f});
  for (const float exponent : {1.0f, 20.0f, 500.0f})
    all.push_back({"metal of exponent " + std::to_string(exponent),
                   {{.kind = Kind::metal, .base_color = Color(1, 1, 1), .exponent = exponent}},
                   exponent > 100});
  return all;
}

inline std::vector<BsdfCase> glass() {
  auto all = with_roughness("glass", {.kind = Kind::glass, .base_color = Color(1, 0.8f, 0.5f), .ior = 1.5f},
                            {0.4f, 0.7f, 1.0f});
  const Material sheet{.kind = Kind::glass, .base_color = Color(1, 0.8f, 0.5f), .ior = 1.5f, .thin = true};
  for (BsdfCase& c : with_roughness("thin glass", sheet, {0.3f, 0.6f, 1.0f})) all.push_back(c);
  return all;
}

inline std::vector<BsdfCase> plastic() {
  return with_roughness("plastic", {.kind = Kind::plastic, .base_color = kPaint, .ior = 1.6f},
                        {0.0f, 0.3f, 0.7f, 1.0f});
}

inline std::vector<BsdfCase> gltf() {
  const auto with = [](auto change) {
    Material m{.kind = Kind::metallic_roughness, .base_color = kPaint, .metallic = 0.2f, .roughness = 0.6f};
    change(m);
    return m;
  };
  std::vector<BsdfCase> all;
  for (const float metallic : {0.0f, 0.5f, 1.0f})
    for (BsdfCase& c : with_roughness("metallic " + std::to_string(metallic),
                                      with([&](Material& m) { m.metallic = metallic; }), {0.3f, 0.7f, 1.0f}))
      all.push_back(c);
  all.push_back({"transmission", {with([](Material& m) { m.transmission = 0.7f; })}});
  all.push_back({"thin transmission", {with([](Material& m) { m.transmission = 0.7f, m.thin = true; })}});
  const auto coat = [](Material& m) { m.clearcoat = 0.8f, m.clearcoat_roughness = 0.5f; };
  const auto sheen = [](Material& m) { m.sheen_color = Color(0.9f, 0.5f, 0.2f), m.sheen_roughness = 0.4f; };
  all.push_back({"clear coat", {with(coat)}});
  all.push_back({"sheen", {with(sheen)}});
  all.push_back({"all of glTF", {with([&](Material& m) { coat(m), sheen(m), m.transmission = 0.5f; })}});
  return all;
}

inline std::vector<BsdfCase> mix() {
  const Material paint{.kind = Kind::diffuse, .base_color = kPaint};
  const Material metal{.kind = Kind::metal, .base_color = Color(1, 1, 1), .roughness = 0.6f};
  const Material mirror{.kind = Kind::mirror, .base_color = Color(0.9f, 0.9f, 0.9f)};
  const Material glass{.kind = Kind::glass, .roughness = 0.8f};
  const auto of = [](int first, int second, float share) {
    return Material{.kind = Kind::mix, .first = first, .second = second, .mix = share};
  };
  return {{"mix of paint and metal", {paint, metal, of(0, 1, 0.3f)}},
          {"mix of paint and a mirror", {paint, mirror, of(0, 1, 0.6f)}},
          {"mix of mixes", {paint, metal, glass, of(0, 1, 0.5f), of(2, 3, 0.7f), of(4, 1, 0.2f)}}};
}

inline std::vector<BsdfCase> every() {
  std::vector<BsdfCase> all;
  for (const auto& family : {diffuse(), metal(), glass(), plastic(), gltf(), mix()})
    all.insert(all.end(), family.begin(), family.end());
  return all;
}

}  // namespace cases

// The unit square as directions: by equal area, or (focused) with most of it about an axis.
class Square {
 public:
  Square() = default;
  explicit Square(const Vec3& axis) : focused_(true), axis_(axis) {}

  Vec3 direction(double x, double y) const {
    if (!focused_) return from_square(x, y);
    const Vec3 d = from_square(x, 1 - y * y * y * y);
    return axis_.to_world(d);
  }
  Vec2 point(const Vec3& direction) const {
    if (!focused_) return on_square(direction);
    const Vec3 chord = direction - axis_.z;
    Vec2 p = on_square(axis_.to_local(direction));
    p.y = std::pow(std::min(1.0f, tracer::dot(chord, chord) / 4), 0.25f);  // versine = chord^2 / 2
    return p;
  }
  // Steradians per area of the square.
  double size(double y) const { return 4 * std::numbers::pi * (focused_ ? 4 * y * y * y : 1.0); }

 private:
  bool focused_ = false;
  tracer::Frame axis_{Vec3(0, 0, 1)};
};

// Where most of the light goes: for glass through, else mirrored.
inline Square square_for(const BsdfCase& c, const Vec3& wo) {
  if (!c.narrow) return Square();
  const Material& m = c.materials.back();
  const float across = m.thin ? 1.0f : wo.z > 0 ? 1 / m.ior : m.ior;
  const float cosine2 = 1 - (1 - wo.z * wo.z) * across * across;
  if (m.kind != Material::Kind::glass || cosine2 < 0) return Square(Vec3(-wo.x, -wo.y, wo.z));
  return Square(Vec3(-wo.x * across, -wo.y * across, std::copysign(std::sqrt(cosine2), -wo.z)));
}

// The integral of a function of directions, by the midpoint rule.
template <typename F>
auto integral_over_directions(const Square& square, int steps, const F& f) {
  auto sum = f(Vec3(0, 0, 1)) * 0.0f;
  for (int j = 0; j < steps; ++j)
    for (int i = 0; i < steps; ++i) {
      const double x = (i + 0.5) / steps, y = (j + 0.5) / steps;
      sum += f(square.direction(x, y)) * static_cast<float>(square.size(y) / (double(steps) * steps));
    }
  return sum;
}

// What comes back and through of light from everywhere: the mean weight of samples, without the radiance that
// refraction adds, and its standard error.
struct Energy {
  Color mean{0, 0, 0};
  float error = 0;
};
inline Energy energy(const Bsdf& b, int tries, unsigned seed = 9) {
  Random random(seed);
  Color sum(0, 0, 0);
  double squares = 0;
  for (int i = 0; i < tries; ++i) {
    const float lobe = random.number();
    const auto s = tracer::sample(b, lobe, random.pair());
    const Color w = s.weight() * (1.0f / s.radiance_scale);
    sum += w;
    squares += tracer::square(tracer::max_component(w));
  }
  const float n = static_cast<float>(tries);
  return {sum * (1 / n),
          float(std::sqrt(std::max(0.0, squares / n - tracer::square(tracer::max_component(sum) / n)) / n))};
}

}  // namespace tessera::testing
