// SPDX-License-Identifier: Apache-2.0
// How a point of a surface scatters light: evaluated, sampled, and with the density of its samples.
#pragma once

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// GGX with less than this alpha is a mirror.
inline constexpr float kSmoothAlpha = 1e-3f;

// Seen from `wo`, which is local: z >= 0. Colours are the material's at this point.
struct Bsdf {
  Material::Kind kind = Material::Kind::diffuse;
  bool delta = false;  // scatters into single directions only
  Frame frame;         // z: the shading normal, on the side of wo
  Vec3 ng;             // unit geometric normal, on the side of wo
  Vec3 wo;             // local
  Color color;         // of diffuse: reflectance; of mirror and glass: factor of reflection, transmission
  Color f0;            // of metallic_roughness: specular reflectance at normal incidence
  Color eta, k;        // of metal
  float alpha = 1;
  float ior = 1.5f;             // of glass: index beyond over index on this side
  Color absorption{0, 0, 0};
  float specular_share = 0.5f;  // of metallic_roughness: probability that a sample is of the specular lobe
};

// f * cosine to the shading normal, apart by kind: diffuse is what Lambert-like lobes scatter (also to the
// other side), specular all else.
struct BsdfValue {
  Color diffuse{0, 0, 0}, specular{0, 0, 0};
  float pdf = 0;  // per steradian, of sample() choosing this direction
  Color f() const { return diffuse + specular; }
};
// wi in the world. Delta parts count as 0.
BsdfValue evaluate(const Bsdf&, const Vec3& wi);

struct BsdfSample {
  Vec3 wi;                                    // world
  Color diffuse{0, 0, 0}, specular{0, 0, 0};  // f * cosine / pdf, apart as above; both black: absorbed
  float pdf = 0;                              // 0: a delta direction
  float radiance_scale = 1;  // of a refraction: (index here / index beyond)^2, contained in the weights
  bool crossed = false;
  Color weight() const { return diffuse + specular; }
};
// `lobe` in [0, 1) chooses among lobes, `u` the direction within.
BsdfSample sample(const Bsdf&, float lobe, const Vec2& u);

// Share of light from everywhere that is scattered towards wo; close, not exact, for rough specular lobes.
Color albedo(const Bsdf&);
inline bool one_lobe(const Bsdf& b) { return b.kind == Material::Kind::diffuse; }
inline bool has_diffuse(const Bsdf& b) { return b.kind == Material::Kind::diffuse || b.kind == Material::Kind::metallic_roughness; }
inline void regularise(Bsdf&, float) {}

}  // namespace tessera::tracer
