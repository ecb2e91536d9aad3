// SPDX-License-Identifier: Apache-2.0
#include "worker/render/material.h"

#include "core/scene/import.h"
#include "worker/render/bsdf/fresnel.h"
#include "worker/render/footprint.h"

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

// Vertex colour and alpha; white if the mesh has none.
Texel vertex_color(const Geometry& geometry, const Hit& hit) {
  const Mesh* mesh = geometry.mesh_at(hit);
  if (!mesh || mesh->colors.empty()) return {1, 1, 1, 1};
  const auto& corner = mesh->triangles[hit.primitive];
  const auto &a = mesh->colors[corner[0]], &b = mesh->colors[corner[1]], &c = mesh->colors[corner[2]];
  Texel mixed;
  for (std::size_t i = 0; i < 4; ++i) mixed[i] = a[i] * (1.0f - hit.u - hit.v) + b[i] * hit.u + c[i] * hit.v;
  return mixed;
}
bool has_vertex_color(const Geometry& geometry, const Hit& hit) {
  const Mesh* mesh = geometry.mesh_at(hit);
  return mesh && !mesh->colors.empty();
}

bool has_sheen(const Material& m) {
  return m.kind == Material::Kind::metallic_roughness && !is_black(m.sheen_color);
}

bool has_texture(Material m) {
  const auto textures = textures_of(m);
  return std::any_of(textures.begin(), textures.end(), [](const Texture* t) { return bool(*t); });
}

// What textures make of a share may be anything: a picture of floats is not bound to 0..1.
float as_share(float x) { return x > 0 ? std::min(x, 1.0f) : 0.0f; }

// Scatters the same whatever the direction of view: its shading normal need not be bent for mirror
// directions.
bool only_lambert(const Material& m) {
  return m.kind == Material::Kind::diffuse || m.kind == Material::Kind::translucent;
}

}  // namespace

// A hit as seen from where the ray comes, while its Bsdf is made.
struct Materials::View {
  const Geometry& geometry;
  const Hit& hit;
  const Surface& surface;
  TexturePoint at;
  Vec3 wo;
  bool front;
  bool faced = false;  // the Bsdf has its own frame
  float solid = 0;     // weight of the solids in it
};

Materials::Materials(const Scene& scene, std::shared_ptr<TextureCache> cache)
    : scene_(&scene),
      textures_(scene, std::move(cache)),
      textured_(scene.materials.size()),
      mean_fresnel_(scene.materials.size(), 0.0f) {
  for (std::size_t i = 0; i < scene.materials.size(); ++i) {
    const Material& m = scene.materials[i];
    if (m.kind == Material::Kind::plastic) mean_fresnel_[i] = mean_dielectric_fresnel(m.ior);
    if (has_sheen(m) && !sheen_) sheen_.emplace();
    plain_.push_back({.lambert = m.kind == Material::Kind::diffuse && !m.normal_texture,
                      .textured = bool(m.base_color_texture),
                      .base_color = m.base_color});
    textured_[i] = m.kind == Material::Kind::mix || has_texture(m);
  }
}

Texel Materials::texel(const Texture& texture, const TexturePoint& at) const {
  const Vec2& uv = texture.uv_set == 0 ? at.uv : at.uv2;
  const auto& t = texture.transform;
  const float scale = std::sqrt(std::abs(t[0] * t[4] - t[1] * t[3]));
  return textures_.lookup(texture, {t[0] * uv.x + t[1] * uv.y + t[2], t[3] * uv.x + t[4] * uv.y + t[5]},
                          at.width * scale);
}

// One channel, 1 where there is no texture.
float Materials::channel(const Texture& texture, std::size_t channel, const TexturePoint& at) const {
  return texture ? texel(texture, at)[channel] : 1.0f;
}

Color Materials::tinted(const Color& factor, const Texture& texture, const TexturePoint& at) const {
  return texture && !is_black(factor) ? factor * rgb(texel(texture, at)) : factor;
}

bool Materials::emits(int material) const {
  const Material& m = (*this)[material];
  return !is_black(m.emission) || (m.kind == Material::Kind::mix && (emits(m.first) || emits(m.second)));
}

Color Materials::emission(int material, const TexturePoint& at) const {
  const Material& m = (*this)[material];
  const Color own = tinted(m.emission, m.emission_texture, at);
  if (m.kind != Material::Kind::mix || !emits(material)) return own;
  return own +
         lerp(emission(m.first, at), emission(m.second, at), as_share(m.mix * channel(m.mix_texture, 0, at)));
}

Color Materials::mean_emission(int material) const {
  const Material& m = (*this)[material];
  const auto mean = [&](const Texture& t) { return t ? textures_.average(t) : Color(1, 1, 1); };
  const Color own = m.emission * mean(m.emission_texture);
  if (m.kind != Material::Kind::mix) return own;
  return own + lerp(mean_emission(m.first), mean_emission(m.second), as_share(m.mix * mean(m.mix_texture).x));
}

float Materials::opacity(const Geometry& geometry, const Hit& hit) const {
  const Material& m = (*this)[geometry.material(hit)];
  if (m.alpha == Material::Alpha::opaque) return 1;
  const float alpha =
      m.base_alpha * channel(m.base_color_texture, 3, {geometry, hit}) * vertex_color(geometry, hit)[3];
  if (m.alpha == Material::Alpha::mask) return alpha >= m.alpha_cutoff ? 1.0f : 0.0f;
  return as_share(alpha);
}

Color Materials::shown(const Geometry& geometry, const Hit& hit, const Surface& s) const {
  return base_color((*this)[s.material], geometry, hit, s);
}

MaterialPoint Materials::at_point(const Material& m, const View& view) const {
  const TexturePoint& at = view.at;
  MaterialPoint p{};
  p.base_color = tinted(m.base_color, m.base_color_texture, at);
  if (has_vertex_color(view.geometry, view.hit)) p.base_color *= rgb(vertex_color(view.geometry, view.hit));
  if (only_lambert(m)) return p;
  p.roughness = m.roughness;
  p.metallic = m.metallic;
  if (m.metallic_roughness_texture) {
    const Texel t = texel(m.metallic_roughness_texture, at);
    p.roughness = as_share(p.roughness * t[1]);
    p.metallic = as_share(p.metallic * t[2]);
  }
  if (m.kind != Material::Kind::metallic_roughness) return p;
  const auto factor = [&](float x, const Texture& t, std::size_t i) {
    return x > 0 ? as_share(x * channel(t, i, at)) : 0.0f;
  };
  p.transmission = factor(m.transmission, m.transmission_texture, 0);
  p.clearcoat = factor(m.clearcoat, m.clearcoat_texture, 0);
  p.clearcoat_roughness = factor(m.clearcoat_roughness, m.clearcoat_roughness_texture, 1);
  p.sheen_color = tinted(m.sheen_color, m.sheen_color_texture, at);
  p.sheen_roughness = factor(m.sheen_roughness, m.sheen_roughness_texture, 3);
  return p;
}

Vec3 Materials::mapped_normal(const Texture& texture, float scale, const View& view) const {
  const Vec3& ns = view.surface.ns;
  Vec3 along_u, up;
  if (!texture || !view.geometry.tangents(view.hit, texture, along_u, up, view.surface.time)) return ns;
  const Texel t = texel(texture, view.at);
  const Vec3 raw = along_u - ns * dot(along_u, ns);
  if (!(dot(raw, raw) > 0)) return ns;
  const Vec3 tangent = unit(raw);
  const Vec3 side = cross(ns, tangent);
  const Vec3 bitangent = dot(side, up) < 0 ? -side : side;
  const Vec3 n =
      tangent * ((2 * t[0] - 1) * scale) + bitangent * ((2 * t[1] - 1) * scale) + ns * (2 * t[2] - 1);
  return dot(n, n) > 0 ? unit(n) : ns;
}

// The shading normal that a normal map makes, as a facing of the Bsdf; as Lobe::facing.
std::uint8_t Materials::facing(const Material& m, const Texture& map, float scale, View& view,
                               Bsdf& b) const {
  Vec3 ns = mapped_normal(map, scale, view);
  if (!view.front) ns = -ns;
  if (!only_lambert(m) || dot(view.wo, ns) <= 0) ns = bent(ns, b.ng, view.wo);
  if (!view.faced) {
    view.faced = true;
    b.frame = Frame(ns);
    b.wo = b.frame.to_local(view.wo);
  }
  if (b.frame.z == ns) return 0;
  for (std::size_t i = 0; i < b.facings.size(); ++i)
    if (b.facings[i].frame.z == ns) return static_cast<std::uint8_t>(i + 1);
  const Frame frame(ns);
  b.facings.add({frame, frame.to_local(view.wo)});
  return static_cast<std::uint8_t>(b.facings.size());
}

void Materials::add_leaf(int material, float weight, View& view, Bsdf& b) const {
  const Material& m = (*this)[material];
  const MaterialPoint p = at_point(m, view);
  Place place{.weight = weight,
              .front = view.front,
              .facing = 0,
              .coat_facing = 0,
              .mean_fresnel = mean_fresnel_[static_cast<std::size_t>(material)]};
  place.facing = facing(m, m.normal_texture, m.normal_scale, view, b);
  if (p.clearcoat > 0)
    place.coat_facing = facing(m, m.clearcoat_normal_texture, m.clearcoat_normal_scale, view, b);
  if (!is_black(p.sheen_color)) b.sheen = &*sheen_;
  add_lobes(m, p, place, b);
  if (!is_solid(m, p)) return;
  view.solid += weight;
  b.absorption = lerp(b.absorption, absorption(m), weight / view.solid);
}

void Materials::add(int material, float weight, View& view, Bsdf& b) const {
  const Material& m = (*this)[material];
  if (m.kind != Material::Kind::mix) return add_leaf(material, weight, view, b);
  const float second = as_share(m.mix * channel(m.mix_texture, 0, view.at));
  if (second < 1) add(m.first, weight * (1.0f - second), view, b);
  if (second > 0) add(m.second, weight * second, view, b);
}

Color Materials::base_color(const Material& m, const Geometry& geometry, const Hit& hit,
                            const TexturePoint& at) const {
  const Color textured = tinted(m.base_color, m.base_color_texture, at);
  return has_vertex_color(geometry, hit) ? textured * rgb(vertex_color(geometry, hit)) : textured;
}

Materials::Lambert Materials::lambert(const Geometry& geometry, const Hit& hit, const Surface& s,
                                      const Vec3& direction) const {
  const Plain& plain = plain_[static_cast<std::size_t>(s.material)];
  const Vec3 wo = -direction;
  const bool front = dot(wo, s.ng) >= 0;
  Lambert l{front ? s.ng : -s.ng, front ? s.ns : -s.ns, plain.base_color};
  if (dot(wo, l.ns) <= 0) l.ns = bent(l.ns, l.ng, wo);
  if (plain.textured) {
    TexturePoint at(s);
    at.width = uv_width(s.cone, dot(wo, s.ng), uv_per_metre(geometry, hit));
    l.reflectance = base_color((*this)[s.material], geometry, hit, at);
  } else if (has_vertex_color(geometry, hit)) {
    l.reflectance *= rgb(vertex_color(geometry, hit));
  }
  return l;
}

Bsdf Materials::bsdf(const Geometry& geometry, const Hit& hit, const Surface& s,
                     const Vec3& direction) const {
  View view{geometry, hit, s, s, -direction, dot(-direction, s.ng) >= 0};
  if (textured_[static_cast<std::size_t>(s.material)])
    view.at.width = uv_width(s.cone, dot(view.wo, s.ng), uv_per_metre(geometry, hit));
  Bsdf b;
  b.ng = view.front ? s.ng : -s.ng;
  add(s.material, 1, view, b);
  balance(b);
  return b;
}

}  // namespace tessera::tracer
