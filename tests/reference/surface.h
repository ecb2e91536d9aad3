// SPDX-License-Identifier: Apache-2.0
// What several references derive from a pixel and the ones beside it.
#pragma once

#include "tests/reference/features.h"

namespace tessera::reference {

// Squared size of a pixel on the surface: distance to the next pixel's point, per axis on the nearer side.
double squared_footprint(const Features&, int x, int y);

// Of the two one-sided differences of depth along (dx, dy) the smaller.
double slope(const Features&, int x, int y, int dx, int dy);

// w_z of Schied et al. 2017, equation 3, as an exponent: |z_p - z_q| / (sigma_z |slope . (p - q)| +
// tolerance).
double depth_exponent(const Features&, int x, int y, int qx, int qy, double sigma_z);

// A picture's variances at p smoothed by a 3x3 Gaussian over its valid pixels.
double smoothed(const Features&, const std::vector<double>& variance, int x, int y);

// The squared length of the difference of two unit normals.
double squared_turn(const Features&, int x, int y, int qx, int qy);

// Each valid q in a window of (2 radius + 1)^2 taps, `step` apart: body(i, j, qx, qy).
template <typename Body>
void each_tap(const Features& f, int x, int y, int radius, int step, const Body& body) {
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i)
      if (f.valid(x + i * step, y + j * step)) body(i, j, x + i * step, y + j * step);
}

template <typename Body>
void each_valid(const Features& f, const Body& body) {
  const Region& r = f.region();
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x)
      if (f.valid(x, y)) body(x, y);
}

}  // namespace tessera::reference
