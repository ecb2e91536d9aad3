// SPDX-License-Identifier: Apache-2.0
// What a material is at a point, as lobes. No textures, no geometry.
#pragma once

#include "worker/render/bsdf/bsdf.h"

namespace tessera::tracer {

// The fields of a Material that textures and vertex colours change, at a point.
struct MaterialPoint {
  Color base_color, sheen_color;
  float metallic, roughness, transmission, clearcoat, clearcoat_roughness, sheen_roughness;
};

// How a material comes into a Bsdf.
struct Place {
  float weight;                      // its share of a mix, 0..1
  bool front;                        // wo is on the front
  std::uint8_t facing, coat_facing;  // as Lobe::facing
  float mean_fresnel;                // of plastic: mean_dielectric_fresnel(ior)
};

// Adds the lobes of a material that is no mix.
void add_lobes(const Material&, const MaterialPoint&, const Place&, Bsdf&);

// True if light that passes goes into a solid, or out.
bool is_solid(const Material&, const MaterialPoint&);

// Per metre: Beer's law, -ln(attenuation_color) / attenuation_distance. Black counts as 1e-30.
Color absorption(const Material&);

}  // namespace tessera::tracer
