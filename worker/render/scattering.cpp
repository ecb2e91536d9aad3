// SPDX-License-Identifier: Apache-2.0
#include "worker/render/scattering.h"

#include "worker/render/bsdf/dielectric.h"
#include "worker/render/bsdf/diffuse.h"

namespace tessera::tracer {
namespace {

Color grey(float x) { return {x, x, x}; }

// GGX alpha of a roughness, 0 where it is a mirror.
float alpha_or_mirror(float roughness) {
  const float alpha = roughness * roughness;
  return alpha < kSmoothAlpha ? 0.0f : alpha;
}
float alpha_or_least(float roughness) { return std::max(roughness * roughness, kSmoothAlpha); }

class LobeList {
 public:
  LobeList(const Place& place, Bsdf& b) : place_(place), b_(b) {}

  // Above what is added after it. At most two.
  void cover(float coat, const Color& sheen, float sheen_alpha) {
    b_.layers.add({coat, max_component(sheen), sheen_alpha, place_.coat_facing, place_.facing});
    layer_ = static_cast<std::uint8_t>(b_.layers.size());
  }
  void add(Lobe l) {
    l.color *= place_.weight;
    if (l.kind == Lobe::Kind::boundary || l.kind == Lobe::Kind::sheet) l.f0 *= place_.weight;
    l.facing = place_.facing;
    l.layer = layer_;
    b_.lobes.add(l);
  }
  void add_coat(Lobe l) {
    l.color *= place_.weight;
    l.facing = place_.coat_facing;
    l.layer = 0;
    b_.lobes.add(l);
  }

 private:
  const Place& place_;
  Bsdf& b_;
  std::uint8_t layer_ = 0;
};

Lobe dielectric_lobe(const Material& m, bool front, float roughness, const Color& through, float reflects) {
  using enum Lobe::Kind;
  Lobe l{.kind = m.thin ? sheet : boundary, .alpha = alpha_or_mirror(roughness)};
  l.ior = m.thin || front ? m.ior : 1.0f / m.ior;
  if (l.kind == boundary && !bends(l.ior, l.alpha)) l.alpha = 0;
  l.color = through;
  l.f0 = grey(reflects);
  return l;
}

void add_metal(const Material& m, const MaterialPoint& p, LobeList& list) {
  const bool phong = m.exponent > 0;
  list.add({.kind = phong ? Lobe::Kind::phong : Lobe::Kind::reflection,
            .fresnel = Lobe::Fresnel::conductor,
            .alpha = phong ? m.exponent : alpha_or_mirror(p.roughness),
            .color = p.base_color,
            .eta = m.eta,
            .k = m.k});
}

void add_plastic(const Material& m, const MaterialPoint& p, float mean_fresnel, LobeList& list) {
  list.add({.kind = Lobe::Kind::reflection,
            .fresnel = Lobe::Fresnel::dielectric,
            .alpha = alpha_or_mirror(p.roughness),
            .ior = m.ior,
            .color = grey(1)});
  list.add(undercoat_lobe(p.base_color, m.ior, mean_fresnel));
}

// Appendix B of glTF 2.0: a metal and a dielectric, by `metallic`. Of the dielectric, `transmission` is a
// boundary (KHR_materials_transmission) and the rest a diffuse base; what reflects is one lobe.
void add_metallic_roughness(const Material& m, const MaterialPoint& p, bool front, LobeList& list) {
  const float dielectric = 1.0f - p.metallic, opaque = 1.0f - p.transmission;
  const float through = dielectric * p.transmission, reflecting = 1.0f - through;
  const Color f0 = lerp(grey(square((1 - m.ior) / (1 + m.ior)) * opaque), p.base_color, p.metallic) *
                   (reflecting > 0 ? 1.0f / reflecting : 0.0f);
  if (reflecting > 0)
    list.add({.kind = Lobe::Kind::reflection,
              .fresnel = Lobe::Fresnel::schlick,
              .alpha = alpha_or_least(p.roughness),
              .color = grey(reflecting),
              .f0 = f0});
  const Color base = p.base_color * (dielectric * opaque);
  if (!is_black(base)) list.add({.kind = Lobe::Kind::coated, .color = base, .f0 = f0});
  if (through > 0) list.add(dielectric_lobe(m, front, p.roughness, p.base_color * through, through));
}

// The clear coat lies on the sheen, the sheen on the rest; KHR_materials_clearcoat, KHR_materials_sheen.
void add_gltf(const Material& m, const MaterialPoint& p, bool front, LobeList& list) {
  const bool coated = p.clearcoat > 0, sheen = !is_black(p.sheen_color);
  if (coated)
    list.add_coat({.kind = Lobe::Kind::reflection,
                   .fresnel = Lobe::Fresnel::schlick,
                   .alpha = alpha_or_least(p.clearcoat_roughness),
                   .color = grey(p.clearcoat),
                   .f0 = grey(0.04f)});
  const float sheen_alpha = std::max(square(p.sheen_roughness), kLeastSheenAlpha);
  if (coated) list.cover(p.clearcoat, grey(0), sheen_alpha);
  if (sheen) list.add({.kind = Lobe::Kind::sheen, .alpha = sheen_alpha, .color = p.sheen_color});
  if (sheen) list.cover(p.clearcoat, p.sheen_color, sheen_alpha);
  add_metallic_roughness(m, p, front, list);
}

}  // namespace

void add_lobes(const Material& m, const MaterialPoint& p, const Place& place, Bsdf& b) {
  LobeList list(place, b);
  switch (m.kind) {
    case Material::Kind::diffuse:
      list.add({.kind = Lobe::Kind::lambert, .color = p.base_color});
      break;
    case Material::Kind::mirror:
      list.add({.kind = Lobe::Kind::reflection, .color = p.base_color});
      break;
    case Material::Kind::glass:
      list.add(dielectric_lobe(m, place.front, p.roughness, p.base_color, 1));
      break;
    case Material::Kind::metal:
      add_metal(m, p, list);
      break;
    case Material::Kind::metallic_roughness:
      add_gltf(m, p, place.front, list);
      break;
    case Material::Kind::translucent:
      list.add({.kind = Lobe::Kind::lambert, .color = p.base_color});
      list.add({.kind = Lobe::Kind::lambert_through, .color = m.transmission_color});
      break;
    case Material::Kind::plastic:
      add_plastic(m, p, place.mean_fresnel, list);
      break;
    case Material::Kind::mix:
    case Material::Kind::unlit:
      break;
  }
}

bool is_solid(const Material& m, const MaterialPoint& p) {
  if (m.thin) return false;
  return m.kind == Material::Kind::glass ||
         (m.kind == Material::Kind::metallic_roughness && p.transmission > 0 && p.metallic < 1);
}

Color absorption(const Material& m) {
  if (!(m.attenuation_distance > 0)) return {0, 0, 0};
  const auto per_metre = [&](float share) {
    return std::max(0.0f, -std::log(std::max(share, 1e-30f)) / m.attenuation_distance);
  };
  return {per_metre(m.attenuation_color.x), per_metre(m.attenuation_color.y),
          per_metre(m.attenuation_color.z)};
}

}  // namespace tessera::tracer
