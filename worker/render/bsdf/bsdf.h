// SPDX-License-Identifier: Apache-2.0
// How a point of a surface scatters light: a mixture of lobes, evaluated, sampled, and with the density of
// its samples.
#pragma once

#include "worker/render/bsdf/few.h"
#include "worker/render/bsdf/lobe.h"
#include "worker/render/bsdf/sheen.h"

namespace tessera::tracer {

// A shading normal other than the Bsdf's own: of a clear coat, or of another material in a mix.
struct Facing {
  Frame frame;  // z: on the side of wo
  Vec3 wo;      // local
};

// What lies above a lobe and takes light from it on the way in or out, whichever is more: the clear coat and
// the sheen of glTF. The same from both ends, so that scattering stays reciprocal; glTF asks one end only.
struct Layer {
  float coat = 0;                    // strength, 0: none
  float sheen = 0, sheen_alpha = 0;  // its greatest component, 0: none
  std::uint8_t coat_facing = 0, facing = 0;
};

// A material of one kind makes up to five lobes, two facings and two layers.
inline constexpr std::size_t kMixed = std::size_t(1) << kMaxMixDepth;
inline constexpr std::size_t kMaxLobes = 5 * kMixed;

// Seen from `wo`, which is local: z >= 0. Only what is there is copied.
struct Bsdf {
  bool delta = true;                   // scatters into single directions only, or not at all
  Frame frame;                         // z: the shading normal, on the side of wo
  Vec3 ng;                             // unit geometric normal, on the side of wo
  Vec3 wo;                             // local
  Color absorption{0, 0, 0};           // per metre, of the solid's inside; 0: clear, thin, or no solid
  const SheenAlbedo* sheen = nullptr;  // borrowed; set if a lobe is sheen
  Few<Lobe, kMaxLobes> lobes;
  Few<Facing, 2 * kMixed> facings;
  Few<Layer, 2 * kMixed> layers;
};

// Sets `delta` and how often each lobe is sampled. To be called once when the lobes are there.
void balance(Bsdf&);

// f * cosine to the shading normal, apart by kind: diffuse is what Lambert-like lobes and sheen scatter (also
// to the other side), specular all else.
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
  bool crossed = false;      // went into or out of a solid
  Color weight() const { return diffuse + specular; }
};
// `lobe` in [0, 1) chooses among lobes, `u` the direction within.
BsdfSample sample(const Bsdf&, float lobe, const Vec2& u);
// sample() does not heed `lobe`.
inline bool one_lobe(const Bsdf& b) {
  return b.lobes.size() == 1 && b.lobes[0].kind != Lobe::Kind::boundary &&
         b.lobes[0].kind != Lobe::Kind::sheet;
}

// Has a lobe that counts as diffuse.
bool has_diffuse(const Bsdf&);

// Share of light from everywhere that is scattered towards wo, but without what rough facets take from one
// another.
Color albedo(const Bsdf&);

// Makes all glossy lobes at least as rough as GGX of `min_alpha` > 0, mirror-like ones too; Kaplanyan and
// Dachsbacher 2013, "Path Space Regularization for Holistic and Robust Light Transport".
void regularise(Bsdf&, float min_alpha);

}  // namespace tessera::tracer
