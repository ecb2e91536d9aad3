// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bsdf/bsdf.h"

#include "worker/render/bsdf/fresnel.h"
#include "worker/render/bsdf/microfacet.h"

namespace tessera::tracer {
namespace {

// f * cosine of the microfacet lobe without its Fresnel factor; directions local, both above.
float microfacet_value(const Vec3& wo, const Vec3& wi, const Vec3& h, float alpha) {
  const float masking = 1.0f / (1.0f + smith_lambda(wo, alpha) + smith_lambda(wi, alpha));
  return ggx(h, alpha) * masking / (4.0f * wo.z);
}

// The lobes of glTF 2.0 appendix B.3. What the specular lobe reflects, the diffuse one lacks: on the way in
// and on the way out, as in Ashikhmin and Shirley 2000, "An Anisotropic Phong BRDF Model" (their section 2.2,
// here for a Lambertian base: 21/20 is what Schlick's term takes from uniform light). The appendix weighs by
// the half vector's cosine instead, which returns up to 1.05 of the light at grazing angles.
Color diffuse_value(const Bsdf& b, const Vec3& wi) {
  const Color white(1, 1, 1);
  return b.color * (white - schlick(b.wo.z, b.f0)) * (white - schlick(wi.z, b.f0)) * (1.05f * kInvPi * wi.z);
}

BsdfValue metallic_roughness_value(const Bsdf& b, const Vec3& wi) {
  const Vec3 h = unit(b.wo + wi);
  return {diffuse_value(b, wi), schlick(dot(b.wo, h), b.f0) * microfacet_value(b.wo, wi, h, b.alpha),
          b.specular_share * visible_reflection_pdf(b.wo, h, b.alpha) +
              (1.0f - b.specular_share) * wi.z * kInvPi};
}

BsdfValue metal_value(const Bsdf& b, const Vec3& wi) {
  const Vec3 h = unit(b.wo + wi);
  return {Color(0),
          b.color * conductor_fresnel(dot(b.wo, h), b.eta, b.k) * microfacet_value(b.wo, wi, h, b.alpha),
          visible_reflection_pdf(b.wo, h, b.alpha)};
}

// wi local; both directions above the surface.
BsdfValue value(const Bsdf& b, const Vec3& wi) {
  switch (b.kind) {
    case Material::Kind::diffuse:
      return {b.color * (wi.z * kInvPi), Color(0), wi.z * kInvPi};
    case Material::Kind::metal:
      return metal_value(b, wi);
    case Material::Kind::metallic_roughness:
      return metallic_roughness_value(b, wi);
    default:
      return {};
  }
}

bool above(const Bsdf& b, const Vec3& wi_local, const Vec3& wi) {
  return wi_local.z > 0 && dot(wi, b.ng) > 0 && b.wo.z > 0;
}

BsdfSample mirrored(const Bsdf& b, const Color& weight) {
  const Vec3 wi = b.frame.to_world({-b.wo.x, -b.wo.y, b.wo.z});
  if (!(dot(wi, b.ng) > 0)) return {};
  return {wi, Color(0), weight, 0, 1};
}

BsdfSample sample_glass(const Bsdf& b, float lobe) {
  const DielectricBoundary boundary = dielectric_fresnel(b.wo.z, b.ior);
  if (lobe < boundary.reflectance) return mirrored(b, Color(1, 1, 1));
  const float across = 1.0f / b.ior;
  const Vec3 wi = b.frame.to_world({-b.wo.x * across, -b.wo.y * across, -boundary.cos_refracted});
  if (!(dot(wi, b.ng) < 0)) return {};
  // Radiance is denser where light is slower; Veach 1997, eq. 5.2.
  return {wi, Color(0), b.color * (across * across), 0, across * across};
}

Vec3 sample_direction(const Bsdf& b, float lobe, const Vec2& u) {
  const bool diffuse = b.kind == Material::Kind::diffuse ||
                       (b.kind == Material::Kind::metallic_roughness && lobe >= b.specular_share);
  return diffuse ? cosine_hemisphere(u) : reflected(b.wo, visible_normal(b.wo, b.alpha, u));
}

}  // namespace

BsdfValue evaluate(const Bsdf& b, const Vec3& wi) {
  const Vec3 local = b.frame.to_local(wi);
  return above(b, local, wi) ? value(b, local) : BsdfValue{};
}

BsdfSample sample(const Bsdf& b, float lobe, const Vec2& u) {
  if (b.kind == Material::Kind::glass) return sample_glass(b, lobe);
  if (b.kind == Material::Kind::mirror) return mirrored(b, b.color);
  if (b.delta) return mirrored(b, b.color * conductor_fresnel(b.wo.z, b.eta, b.k));
  const Vec3 local = sample_direction(b, lobe, u);
  const Vec3 wi = b.frame.to_world(local);
  if (!above(b, local, wi)) return {};
  if (b.kind == Material::Kind::diffuse) return {wi, b.color, Color(0), local.z * kInvPi, 1};
  const BsdfValue v = value(b, local);
  if (!(v.pdf > 0)) return {};
  return {wi, v.diffuse * (1.0f / v.pdf), v.specular * (1.0f / v.pdf), v.pdf, 1};
}

Color albedo(const Bsdf& b) {
  switch (b.kind) {
    case Material::Kind::glass: {
      const float r = dielectric_fresnel(b.wo.z, b.ior).reflectance;
      return Color(r, r, r) + b.color * (1.0f - r);
    }
    case Material::Kind::metal:
      return b.color * conductor_fresnel(b.wo.z, b.eta, b.k);
    case Material::Kind::metallic_roughness: {
      const Color white(1, 1, 1), specular = schlick(b.wo.z, b.f0);
      return specular + b.color * (white - b.f0) * (white - specular);
    }
    default:
      return b.color;
  }
}

}  // namespace tessera::tracer
