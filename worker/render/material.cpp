// SPDX-License-Identifier: Apache-2.0
#include "worker/render/material.h"

#include "worker/render/bsdf/fresnel.h"
#include "worker/render/texture.h"

namespace tessera::tracer {
namespace {

Color rgb(const Texel& t) { return {t[0], t[1], t[2]}; }

// A shading normal under which the mirror direction of `wo` stays above the geometric surface, so that no
// light is lost there and none leaks through; Keller et al. 2017, "The Iray Light Transport Simulation and
// Rendering System", appendix A.3.
Vec3 bent(const Vec3& ns, const Vec3& ng, const Vec3& wo) {
  const Vec3 mirrored = reflected(wo, ns);
  const float height = dot(mirrored, ng);
  constexpr float kLeast = 1e-3f;
  if (height >= kLeast && dot(wo, ns) > 0) return ns;
  const Vec3 half = wo + unit(mirrored + ng * (kLeast - height));
  return dot(half, half) > 1e-6f && dot(half, wo) > 0 ? unit(half) : ng;
}

// How often to sample the specular lobe: its share of the light scattered towards wo, but neither never nor
// always, for the estimate is rough.
float specular_share(const Bsdf& b) {
  const float specular = luminance(schlick(b.wo.z, b.f0));
  const float diffuse = luminance(b.color) * (1.0f - specular);
  return diffuse > 0 ? std::clamp(specular / (specular + diffuse), 0.1f, 0.9f) : 1.0f;
}

}  // namespace

Color Materials::emission(int material, const Vec2& uv) const {
  const Material& m = (*this)[material];
  if (!m.emission_texture || is_black(m.emission)) return m.emission;
  return m.emission * rgb(lookup(*scene_, m.emission_texture, uv));
}

Color Materials::mean_emission(int material) const {
  const Material& m = (*this)[material];
  if (!m.emission_texture) return m.emission;
  return m.emission * average(scene_->pictures[static_cast<std::size_t>(m.emission_texture.picture)]);
}

bool Materials::solid(int material, const Vec2& uv) const {
  const Material& m = (*this)[material];
  if (m.alpha != Material::Alpha::mask) return true;
  const float alpha =
      m.base_color_texture ? m.base_alpha * lookup(*scene_, m.base_color_texture, uv)[3] : m.base_alpha;
  return alpha >= m.alpha_cutoff;
}

Vec3 Materials::mapped_normal(const Material& m, const Geometry& geometry, const Hit& hit,
                              const Surface& s) const {
  Vec3 along_u, up;
  if (!geometry.tangents(hit, m.normal_texture, along_u, up, s.time)) return s.ns;
  const Texel t = lookup(*scene_, m.normal_texture, s.uv);
  const Vec3 raw = along_u - s.ns * dot(along_u, s.ns);
  if (!(dot(raw, raw) > 0)) return s.ns;
  const Vec3 tangent = unit(raw);
  const Vec3 side = cross(s.ns, tangent);
  const Vec3 bitangent = dot(side, up) < 0 ? -side : side;
  const Vec3 n = tangent * ((2 * t[0] - 1) * m.normal_scale) + bitangent * ((2 * t[1] - 1) * m.normal_scale) +
                 s.ns * (2 * t[2] - 1);
  return dot(n, n) > 0 ? unit(n) : s.ns;
}

Bsdf Materials::bsdf(const Geometry& geometry, const Hit& hit, const Surface& s,
                     const Vec3& direction) const {
  const Material& m = (*this)[s.material];
  const Vec3 wo = -direction;
  const bool front = dot(wo, s.ng) >= 0;
  Bsdf b;
  b.kind = m.kind;
  b.ng = front ? s.ng : -s.ng;
  Vec3 ns = m.normal_texture ? mapped_normal(m, geometry, hit, s) : s.ns;
  if (!front) ns = -ns;
  if (m.kind != Material::Kind::diffuse || dot(wo, ns) <= 0) ns = bent(ns, b.ng, wo);
  b.frame = Frame(ns);
  b.wo = b.frame.to_local(wo);
  b.color =
      m.base_color_texture ? m.base_color * rgb(lookup(*scene_, m.base_color_texture, s.uv)) : m.base_color;
  if (m.kind == Material::Kind::diffuse) return b;
  float roughness = m.roughness, metallic = m.metallic;
  if (m.metallic_roughness_texture) {
    const Texel t = lookup(*scene_, m.metallic_roughness_texture, s.uv);
    roughness *= t[1];
    metallic *= t[2];
  }
  b.alpha = roughness * roughness;
  b.ior = front ? m.ior : 1.0f / m.ior;
  b.eta = m.eta;
  b.k = m.k;
  b.delta = m.kind == Material::Kind::mirror || m.kind == Material::Kind::glass ||
            (m.kind == Material::Kind::metal && b.alpha < kSmoothAlpha);
  if (m.kind == Material::Kind::metallic_roughness) {
    const float reflectance = square((1 - m.ior) / (1 + m.ior));
    b.f0 = lerp(Color(reflectance, reflectance, reflectance), b.color, metallic);
    b.color = b.color * (1.0f - metallic);
    b.alpha = std::max(b.alpha, kSmoothAlpha);
    b.specular_share = specular_share(b);
  }
  return b;
}

}  // namespace tessera::tracer
