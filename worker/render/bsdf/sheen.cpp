// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bsdf/sheen.h"

namespace tessera::tracer {
namespace {

// The fit L of Lambda for a roughness, Estevez and Kulla 2017, table 1: between alpha 1 and 0 by (1 -
// alpha)^2.
struct SheenFit {
  float a, b, c, d, e;

  explicit SheenFit(float alpha) {
    const float t = square(1.0f - alpha);
    a = 21.5473f + t * (25.3245f - 21.5473f);
    b = 3.82987f + t * (3.32435f - 3.82987f);
    c = 0.19823f + t * (0.16801f - 0.19823f);
    d = -1.97760f + t * (-1.27393f + 1.97760f);
    e = -4.32054f + t * (-4.85967f + 4.32054f);
  }
  float log_lambda(float x) const { return a / (1.0f + b * std::pow(x, c)) + d * x + e; }
  float lambda(float cosine) const {
    return std::exp(cosine < 0.5f ? log_lambda(cosine) : 2 * log_lambda(0.5f) - log_lambda(1.0f - cosine));
  }
};

// Their eq. 2: (2 + 1/alpha) / (2 pi) sin^(1/alpha).
float charlie(float sin2, float alpha) {
  return (2.0f + 1.0f / alpha) * (0.5f * kInvPi) * std::pow(sin2, 0.5f / alpha);
}

float charlie_value(const SheenFit& fit, float lambda_wo, float alpha, const Vec3& wo, const Vec3& wi) {
  const Vec3 h = unit(wo + wi);
  const float sin2 = std::min(1.0f, h.x * h.x + h.y * h.y);
  return charlie(sin2, alpha) / (4.0f * wo.z * (1.0f + lambda_wo + fit.lambda(std::min(1.0f, wi.z))));
}

// Where the table has its points: densest at grazing angles and low roughness.
float table_cosine(std::size_t i, std::size_t count) {
  return square((static_cast<float>(i) + 0.5f) / static_cast<float>(count));
}
float table_alpha(std::size_t i, std::size_t count) {
  return std::max(kLeastSheenAlpha, square(static_cast<float>(i) / static_cast<float>(count - 1)));
}

// The integral over all directions above, by the midpoint rule.
float sheen_integral(float cosine, float alpha) {
  constexpr int kHeights = 48, kTurns = 24;
  const SheenFit fit(alpha);
  const float lambda_wo = fit.lambda(cosine);
  const Vec3 wo{root(1 - cosine * cosine), 0, cosine};
  float sum = 0;
  for (int i = 0; i < kHeights; ++i) {
    const float t = (static_cast<float>(i) + 0.5f) / kHeights, z = t * t, r = root(1 - z * z);
    for (int j = 0; j < kTurns; ++j) {
      const float angle = kPi * (static_cast<float>(j) + 0.5f) / kTurns;
      sum += 2 * t * charlie_value(fit, lambda_wo, alpha, wo, {r * std::cos(angle), r * std::sin(angle), z});
    }
  }
  return sum * (2 * kPi / (kHeights * kTurns));
}

// The table's point at or below x and the share of the next.
struct Step {
  std::size_t first;
  float share;
};
Step step_at(float x, std::size_t count) {
  x = std::clamp(x, 0.0f, static_cast<float>(count - 1));
  const auto first = std::min(static_cast<std::size_t>(x), count - 2);
  return {first, x - static_cast<float>(first)};
}

}  // namespace

float raw_sheen_value(float alpha, const Vec3& wo, const Vec3& wi) {
  const SheenFit fit(alpha);
  return charlie_value(fit, fit.lambda(std::min(1.0f, wo.z)), alpha, wo, wi);
}

SheenAlbedo::SheenAlbedo() {
  for (std::size_t r = 0; r < kRoughnesses; ++r)
    for (std::size_t c = 0; c < kCosines; ++c)
      table_[r][c] = sheen_integral(table_cosine(c, kCosines), table_alpha(r, kRoughnesses));
}

float SheenAlbedo::operator()(float cosine, float alpha) const {
  const Step c = step_at(root(cosine) * kCosines - 0.5f, kCosines);
  const Step r = step_at(root(alpha) * (kRoughnesses - 1), kRoughnesses);
  const auto row = [&](std::size_t i) {
    return table_[i][c.first] + (table_[i][c.first + 1] - table_[i][c.first]) * c.share;
  };
  const float low = row(r.first);
  return low + (row(r.first + 1) - low) * r.share;
}

}  // namespace tessera::tracer
