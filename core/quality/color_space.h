// SPDX-License-Identifier: Apache-2.0
// Colour spaces of perception, from linear sRGB and relative to its white (D65). XYZ are divided by those of
// white, so that white is (1, 1, 1) and greys have three equal values.
#pragma once

#include <array>
#include <cmath>

namespace tessera {

using Triple = std::array<float, 3>;

// X, Y, Z of R, G, B: IEC 61966-2-1's primaries and white, as exact quotients of their chromaticities.
inline constexpr double kXyzOfRgb[3][3] = {
    {10135552.0 / 24577794, 8788810.0 / 24577794, 4435075.0 / 24577794},
    {2613072.0 / 12288897, 8788810.0 / 12288897, 887015.0 / 12288897},
    {1425312.0 / 73733382, 8788810.0 / 73733382, 70074185.0 / 73733382}};
inline constexpr double kWhite[3] = {kXyzOfRgb[0][0] + kXyzOfRgb[0][1] + kXyzOfRgb[0][2],
                                     kXyzOfRgb[1][0] + kXyzOfRgb[1][1] + kXyzOfRgb[1][2],
                                     kXyzOfRgb[2][0] + kXyzOfRgb[2][1] + kXyzOfRgb[2][2]};

struct Matrix3 {
  float at[3][3];
  Triple operator*(const Triple& v) const {
    Triple out;
    for (int i = 0; i < 3; ++i) out[i] = at[i][0] * v[0] + at[i][1] * v[1] + at[i][2] * v[2];
    return out;
  }
};

// XYZ / white of linear RGB, and back.
constexpr Matrix3 xyz_of_rgb() {
  Matrix3 m{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m.at[i][k] = static_cast<float>(kXyzOfRgb[i][k] / kWhite[i]);
  return m;
}
constexpr Matrix3 rgb_of_xyz() {
  const auto& a = kXyzOfRgb;
  const auto cofactor = [&](int i, int k) {
    const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, k1 = (k + 1) % 3, k2 = (k + 2) % 3;
    return a[i1][k1] * a[i2][k2] - a[i1][k2] * a[i2][k1];
  };
  const double determinant = a[0][0] * cofactor(0, 0) + a[0][1] * cofactor(0, 1) + a[0][2] * cofactor(0, 2);
  Matrix3 m{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) m.at[i][k] = static_cast<float>(cofactor(k, i) / determinant * kWhite[k]);
  return m;
}

// CIE 1976: the cube root with a straight line near black. Lightness is L* = 116 f(Y) - 16.
inline float lightness_root(float t) {
  constexpr float kDelta = 6.0f / 29.0f;
  return t > kDelta * kDelta * kDelta ? std::cbrt(t) : t / (3 * kDelta * kDelta) + 4.0f / 29.0f;
}

// L*, a*, b* and L*, u*, v* of XYZ / white.
inline Triple lab(const Triple& xyz) {
  const float x = lightness_root(xyz[0]), y = lightness_root(xyz[1]), z = lightness_root(xyz[2]);
  return {116 * y - 16, 500 * (x - y), 200 * (y - z)};
}
inline Triple luv(const Triple& xyz) {
  // u' = 4 X / (X + 15 Y + 3 Z), v' = 9 Y / (...); black has the chromaticity of white.
  constexpr float kX = static_cast<float>(kWhite[0]), kZ = static_cast<float>(kWhite[2]);
  constexpr float kWhiteSum = kX + 15.0f + 3.0f * kZ, kU = 4 * kX / kWhiteSum, kV = 9 / kWhiteSum;
  const float x = kX * xyz[0], y = xyz[1], sum = x + 15 * y + 3 * kZ * xyz[2];
  const float lightness = 116 * lightness_root(y) - 16;
  if (sum == 0) return {lightness, 0, 0};
  return {lightness, 13 * lightness * (4 * x / sum - kU), 13 * lightness * (9 * y / sum - kV)};
}

}  // namespace tessera
