// SPDX-License-Identifier: Apache-2.0
// One way in which a surface scatters light: what kind, and its numbers. The formulas are beside, one file a
// family.
#pragma once

#include <cstdint>

#include "worker/render/vector_math.h"

namespace tessera::tracer {

// GGX with less than this alpha is a mirror.
inline constexpr float kSmoothAlpha = 1e-3f;

// The weight in a mix is part of the colours.
struct Lobe {
  enum class Kind : std::uint8_t {
    lambert,          // back, by `color`
    lambert_through,  // to the other side, by `color`
    coated,           // Lambert under a reflection of `f0`, by `color`
    undercoat,        // Lambert under a dielectric boundary of `ior`, by `color`; f0: see diffuse.h
    reflection,       // GGX, or a mirror; `color` times `fresnel`
    boundary,         // of a dielectric solid: reflects and refracts, GGX or smooth
    sheet,            // of a thin dielectric: reflects and lets through, GGX or smooth
    phong,            // a power of the mirror direction's cosine; `color` times `fresnel`
    sheen,            // fibres, by `color`
  };
  enum class Fresnel : std::uint8_t { none, schlick, conductor, dielectric };

  Kind kind = Kind::lambert;
  Fresnel fresnel = Fresnel::none;
  std::uint8_t facing = 0;  // 0: the Bsdf's own frame, else one more than an index into its facings
  std::uint8_t layer = 0;   // 0: nothing lies above, else one more than an index into the Bsdf's layers
  float share = 1;          // probability that sample() takes this lobe
  float alpha = 0;          // of GGX, 0: smooth; of sheen; of phong, its exponent
  float ior = 1;            // index beyond over index on this side; of sheet and undercoat, over air
  Color color{0, 0, 0};     // of boundary and sheet: the factor of what goes through
  Color f0{0, 0, 0};  // of schlick and coated: at normal incidence; of boundary and sheet: factor of what is
                      // reflected
  Color eta{0, 0, 0}, k{0, 0, 0};  // of conductor
};
static_assert(sizeof(Lobe) <= 64);

// Scatters into single directions.
inline bool is_delta(const Lobe& l) {
  return l.alpha == 0 &&
         (l.kind == Lobe::Kind::reflection || l.kind == Lobe::Kind::boundary || l.kind == Lobe::Kind::sheet);
}
// Counts as diffuse: Lambert-like, the same from everywhere or nearly so.
inline bool is_diffuse(const Lobe& l) {
  return l.kind < Lobe::Kind::reflection || l.kind == Lobe::Kind::sheen;
}

// f * cosine, and the density of the lobe's own samples per steradian.
struct LobeValue {
  Color f{0, 0, 0};
  float pdf = 0;
};

}  // namespace tessera::tracer
