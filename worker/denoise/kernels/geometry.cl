// SPDX-License-Identifier: Apache-2.0
// What the a-trous filters share: how large a pixel is on the surface that it sees and how that surface slopes (by
// the pixels beside it, for a filter that takes only means knows no derivatives); windows; smoothed variance; weights.

// Exponents of weights are counted in float's own bits, from that of 1: 2^t has the exponent (t + 127) 2^23. Scales are
// multiplied by 2^23 where they are divided, and cost nothing.

// The number whose exponent is e <= OF_ONE. Relative error below 4e-6, and 3e-6 for each rounding of e; exactly 1 at
// OF_ONE; below 2^-126 0 or denormal, which is the same to what comes after. The mantissa m in [1, 2) becomes 2^(m - 1)
// by a polynomial of degree 4, the best one of those that meet it at both ends, which stays in [1, 2) after rounding
// (tried for every m). Not exp2_of_negative: this takes two thirds of its instructions.
INLINE vf weight_of(vf e) {
  const int exponent = 0xff800000;
  const vi bits = to_int(e > (vf)0.0f ? e : (vf)0.0f);
  const vf m = as_vf((bits & ~exponent) | 0x3f800000);
  vf p = 0.0135557475f;
  p = fma(p, m, (vf)-0.00219061994f);
  p = fma(p, m, (vf)0.16661714f);
  p = fma(p, m, (vf)0.312146723f);
  p = fma(p, m, (vf)0.509871006f);
  return as_vf((as_vi(p) & ~exponent) | (bits & exponent));
}

// Of what is divided by next to nothing: 0 times it stays 0.
INLINE vf finite_scale(vf scale) { return scale < (vf)1e37f ? scale : (vf)1e37f; }

// Exponents of kB3, less that of 1.
constant float kLogB3[5] = {-4 * EXPONENT_UNIT, -2 * EXPONENT_UNIT, -1.41503750f * EXPONENT_UNIT, -2 * EXPONENT_UNIT,
                            -4 * EXPONENT_UNIT};

// Squared distance of the surface points seen at pixels p and q. points: three planes, 0 is +infinity at invalid
// pixels.
vf squared_distance(global const float* points, long plane, size_t p, size_t q) {
  const vf x = load(points + q) - load(points + p);
  const vf y = load(points + plane + q) - load(points + plane + p);
  const vf z = load(points + 2 * plane + q) - load(points + 2 * plane + p);
  return fma(x, x, fma(y, y, z * z));
}

// The smaller of two, 0 if neither is finite: the neighbour across an edge says nothing about this surface.
vf smaller_if_any(vf a, vf b) {
  const vf least = a < b ? a : b;
  return least < (vf)1e24f ? least : (vf)0.0f;
}

// Squared distance to the next pixel's surface point, both axes as a diagonal.
vf squared_footprint(global const float* points, int stride, long plane, size_t p) {
  return smaller_if_any(squared_distance(points, plane, p, p - 1), squared_distance(points, plane, p, p + 1)) +
         smaller_if_any(squared_distance(points, plane, p, p - stride),
                        squared_distance(points, plane, p, p + stride));
}

// The one-sided difference of smaller magnitude: the larger one may cross an edge. 0 if neither side is valid.
vf slope(vf before, vf centre, vf after) {
  const vf back = centre - before, ahead = after - centre;
  const vf least = fabs(back) < fabs(ahead) ? back : ahead;
  return fabs(least) < (vf)INFINITY ? least : (vf)0.0f;
}

// Runs BODY for both ends q of every chord (i, j) of the (2 RADIUS + 1)^2 window: they share what SCALE yields of i and
// j, which is computed one chord ahead, so that nothing waits for its division.
#define FOR_EACH_CHORD(RADIUS, SCALE, BODY)                                          \
  vf next_scale;                                                                     \
  int next_i = 1, next_j = 0;                                                        \
  {                                                                                  \
    const int i = next_i, j = next_j;                                                \
    next_scale = SCALE;                                                              \
  }                                                                                  \
  _Pragma("nounroll") for (int left = 2 * RADIUS * (RADIUS + 1); left > 0; --left) { \
    const int at_i = next_i, at_j = next_j;                                          \
    const vf scale = next_scale;                                                     \
    next_j = at_i < RADIUS ? at_j : at_j + 1;                                        \
    next_i = at_i < RADIUS ? at_i + 1 : -RADIUS;                                     \
    {                                                                                \
      const int i = next_i, j = next_j;                                              \
      next_scale = SCALE;                                                            \
    }                                                                                \
    const int i = at_i, j = at_j;                                                    \
    const long chord = (long)(j * step) * stride + i * step;                         \
    _Pragma("unroll") for (int end = -1; end <= 1; end += 2) {                       \
      const size_t q = p + end * chord;                                              \
      BODY                                                                           \
    }                                                                                \
  }

// The variance at p smoothed by the 3x3 Gaussian (1/4, 1/2, 1/4)^2 over the valid pixels: steers, is not passed on.
vf smoothed_variance(global const float* guides, global const float* variance, int stride, size_t p) {
  vf sum = 0.0f, total = 0.0f;
#pragma unroll
  for (int j = -1; j <= 1; ++j) {
#pragma unroll
    for (int i = -1; i <= 1; ++i) {
      const size_t q = p + (long)j * stride + i;
      const vf g = load(guides + q) < (vf)INFINITY ? (vf)((i ? 0.25f : 0.5f) * (j ? 0.25f : 0.5f)) : (vf)0.0f;
      sum += g;
      total = fma(g, load(variance + q), total);
    }
  }
  return total / sum;
}
