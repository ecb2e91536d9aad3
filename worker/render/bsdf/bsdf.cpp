// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bsdf/bsdf.h"

#include "worker/render/bsdf/dielectric.h"
#include "worker/render/bsdf/diffuse.h"
#include "worker/render/bsdf/reflection.h"

namespace tessera::tracer {
namespace {

const Frame& frame_of(const Bsdf& b, std::uint8_t facing) {
  return facing == 0 ? b.frame : b.facings[facing - 1u].frame;
}
const Vec3& wo_of(const Bsdf& b, std::uint8_t facing) {
  return facing == 0 ? b.wo : b.facings[facing - 1u].wo;
}

// A clear coat has an index of 1.5, as KHR_materials_clearcoat says.
float coat_reflectance(float cosine) { return schlick(std::abs(cosine), Color(0.04f)).x; }

// What the layers above a lobe leave of light between wo and wi, a unit vector of the world.
float left_by_layers(const Bsdf& b, const Lobe& l, const Vec3& wi) {
  if (l.layer == 0) return 1;
  const Layer& layer = b.layers[l.layer - 1u];
  float left = 1;
  if (layer.coat > 0) {
    const float out = coat_reflectance(wo_of(b, layer.coat_facing).z);
    const float in = coat_reflectance(dot(wi, frame_of(b, layer.coat_facing).z));
    left *= 1.0f - layer.coat * std::max(out, in);
  }
  if (layer.sheen > 0) {
    const float out = (*b.sheen)(wo_of(b, layer.facing).z, layer.sheen_alpha);
    const float in = (*b.sheen)(std::abs(dot(wi, frame_of(b, layer.facing).z)), layer.sheen_alpha);
    left *= 1.0f - layer.sheen * std::min(1.0f, std::max(out, in));
  }
  return left;
}

bool goes_through(const Lobe& l) {
  using enum Lobe::Kind;
  return l.kind == lambert_through || l.kind == boundary || l.kind == sheet;
}

// Which side wi is on: 1 with wo, -1 beyond; 0: neither, for the shading normal and the geometric one
// disagree.
int side_of(const Bsdf& b, const Vec3& wo, const Vec3& local, const Vec3& wi) {
  const float height = dot(wi, b.ng);
  if (!(wo.z > 0)) return 0;
  if (local.z > 0 && height > 0) return 1;
  return local.z < 0 && height < 0 ? -1 : 0;
}

// Of a lobe that is no delta, without layers; local directions, wi on the side `side`.
LobeValue value(const Bsdf& b, const Lobe& l, const Vec3& wo, const Vec3& wi, int side) {
  using enum Lobe::Kind;
  if (side < 0) {
    if (l.kind == lambert_through) return lambert_value(l, -wi.z);
    return l.kind == boundary || l.kind == sheet ? dielectric_value(l, wo, wi) : LobeValue{};
  }
  switch (l.kind) {
    case lambert:
      return lambert_value(l, wi.z);
    case lambert_through:
      return {};
    case coated:
      return coated_value(l, wo, wi);
    case undercoat:
      return undercoat_value(l, wo, wi);
    case reflection:
      return reflection_value(l, wo, wi);
    case boundary:
    case sheet:
      return dielectric_value(l, wo, wi);
    case phong:
      return phong_value(l, wo, wi);
    case sheen:
      return sheen_value(l, *b.sheen, wo, wi);
  }
  return {};
}

// Of all lobes; `local` is wi in the Bsdf's own frame.
BsdfValue mixture(const Bsdf& b, const Vec3& local, const Vec3& wi) {
  BsdfValue sum;
  for (const Lobe& l : b.lobes) {
    if (is_delta(l)) continue;
    const Vec3 here = l.facing == 0 ? local : frame_of(b, l.facing).to_local(wi);
    const Vec3& wo = wo_of(b, l.facing);
    const int side = side_of(b, wo, here, wi);
    if (side == 0) continue;
    const LobeValue v = value(b, l, wo, here, side);
    sum.pdf += l.share * v.pdf;
    (is_diffuse(l) ? sum.diffuse : sum.specular) += l.layer == 0 ? v.f : v.f * left_by_layers(b, l, wi);
  }
  return sum;
}

// A local direction by the lobe's density. `choice` in [0, 1) is for lobes that have two sides.
Vec3 direction(const Lobe& l, const Vec3& wo, float choice, const Vec2& u) {
  using enum Lobe::Kind;
  switch (l.kind) {
    case lambert_through: {
      const Vec3 d = cosine_hemisphere(u);
      return {d.x, d.y, -d.z};
    }
    case reflection:
      return l.alpha > 0 ? reflected(wo, visible_normal(wo, l.alpha, u)) : mirror_direction(wo);
    case boundary:
    case sheet:
      return dielectric_direction(l, wo, choice, u);
    case phong:
      return phong_direction(l, wo, u);
    case sheen:
      return sheen_direction(u);
    default:
      return cosine_hemisphere(u);
  }
}

// Of a smooth lobe: what it scatters over the probability of its one or two directions.
Color delta_weight(const Lobe& l, const Vec3& wo, int side) {
  if (l.kind == Lobe::Kind::reflection) return l.color * fresnel(l, wo.z);
  if (side > 0) return l.f0;
  // Radiance is denser where light is slower; Veach 1997, eq. 5.2.
  return l.kind == Lobe::Kind::boundary ? l.color * square(1.0f / l.ior) : l.color;
}

// The lobe that a number in [0, 1) falls on, and where on it, again in [0, 1).
struct Chosen {
  const Lobe& lobe;
  float rest;
};
Chosen chosen(const Bsdf& b, float number) {
  std::size_t i = 0;
  while (i + 1 < b.lobes.size() && number >= b.lobes[i].share) number -= b.lobes[i++].share;
  const Lobe& l = b.lobes[i];
  return {l, std::clamp(number / l.share, 0.0f, 1.0f - 0x1p-24f)};
}

BsdfSample lambert_sample(const Bsdf& b, const Vec2& u) {
  const Vec3 local = cosine_hemisphere(u);
  const Vec3 wi = b.frame.to_world(local);
  if (side_of(b, b.wo, local, wi) <= 0) return {};
  return {wi, b.lobes[0].color, Color(0), local.z * kInvPi};
}

bool plain_lambert(const Bsdf& b) {
  return b.lobes.size() == 1 && b.lobes[0].kind == Lobe::Kind::lambert && b.lobes[0].layer == 0;
}

Color lobe_albedo(const Bsdf& b, const Lobe& l) {
  using enum Lobe::Kind;
  const Vec3& wo = wo_of(b, l.facing);
  switch (l.kind) {
    case lambert:
    case lambert_through:
      return l.color;
    case coated:
      return coated_albedo(l, wo);
    case undercoat:
      return undercoat_albedo(l, wo);
    case reflection:
      return l.color * fresnel(l, wo.z);
    case phong:  // of a narrow lobe
      return l.color * fresnel(l, wo.z) * wo.z;
    case boundary:
    case sheet: {
      const float r = boundary_reflectance(l, wo.z);
      return l.f0 * r + l.color * (1.0f - r);
    }
    case sheen:
      return l.color * std::min(1.0f, (*b.sheen)(wo.z, l.alpha));
  }
  return {0, 0, 0};
}

// With what lies above, as a mirror direction sees it.
Color layered_albedo(const Bsdf& b, const Lobe& l) {
  const Vec3& wo = wo_of(b, l.facing);
  return lobe_albedo(b, l) * left_by_layers(b, l, frame_of(b, l.facing).to_world(mirror_direction(wo)));
}

void set_delta(Bsdf& b) {
  b.delta = true;
  for (const Lobe& l : b.lobes) b.delta &= is_delta(l);
}

}  // namespace

// By what the lobes scatter towards wo, but each at least now and then, for that is an estimate.
void balance(Bsdf& b) {
  set_delta(b);
  if (b.lobes.size() == 1) b.lobes[0].share = 1;
  if (b.lobes.size() < 2) return;
  const auto count = static_cast<float>(b.lobes.size());
  float sum = 0;
  for (Lobe& l : b.lobes) sum += l.share = luminance(layered_albedo(b, l));
  const float least = std::min(0.1f, 0.4f / count);
  float raised = 0, rest = 0;
  for (Lobe& l : b.lobes) {
    l.share = sum > 0 ? l.share / sum : 1.0f / count;
    l.share < least ? raised += least : rest += l.share;
  }
  for (Lobe& l : b.lobes) l.share = l.share < least ? least : l.share * ((1.0f - raised) / rest);
}

BsdfValue evaluate(const Bsdf& b, const Vec3& wi) {
  const Vec3 local = b.frame.to_local(wi);
  if (!plain_lambert(b)) return mixture(b, local, wi);
  if (side_of(b, b.wo, local, wi) <= 0) return {};
  const LobeValue v = lambert_value(b.lobes[0], local.z);
  return {v.f, Color(0), v.pdf};
}

BsdfSample sample(const Bsdf& b, float number, const Vec2& u) {
  if (b.lobes.empty()) return {};
  if (plain_lambert(b)) return lambert_sample(b, u);
  const auto [l, rest] = chosen(b, number);
  const Vec3& wo = wo_of(b, l.facing);
  const Vec3 local = direction(l, wo, rest, u);
  const Vec3 wi = frame_of(b, l.facing).to_world(local);
  const int side = side_of(b, wo, local, wi);
  if (side == 0 || (side < 0 && !goes_through(l))) return {};
  BsdfSample s{wi};
  s.crossed = side < 0 && l.kind == Lobe::Kind::boundary;
  if (s.crossed) s.radiance_scale = square(1.0f / l.ior);
  if (is_delta(l)) {
    s.specular = delta_weight(l, wo, side) * (left_by_layers(b, l, wi) / l.share);
    return s;
  }
  const BsdfValue v = mixture(b, l.facing == 0 ? local : b.frame.to_local(wi), wi);
  if (!(v.pdf > 0)) return {};
  s.diffuse = v.diffuse * (1.0f / v.pdf);
  s.specular = v.specular * (1.0f / v.pdf);
  s.pdf = v.pdf;
  return s;
}

bool has_diffuse(const Bsdf& b) { return std::any_of(b.lobes.begin(), b.lobes.end(), is_diffuse); }

Color albedo(const Bsdf& b) {
  Color sum(0, 0, 0);
  for (const Lobe& l : b.lobes) sum += layered_albedo(b, l);
  return sum;
}

void regularise(Bsdf& b, float min_alpha) {
  using enum Lobe::Kind;
  for (Lobe& l : b.lobes) {
    if (l.kind == boundary && !bends(l.ior, min_alpha)) continue;
    if (l.kind == reflection || l.kind == boundary || l.kind == sheet) l.alpha = std::max(l.alpha, min_alpha);
    if (l.kind == phong) l.alpha = std::min(l.alpha, phong_exponent(min_alpha));
  }
  set_delta(b);
}

}  // namespace tessera::tracer
