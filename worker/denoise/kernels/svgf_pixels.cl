// SPDX-License-Identifier: Apache-2.0
// Variance-guided filtering, its ends: pixels as a frame has them, made ready for the levels; and the picture that is made
// of what the levels leave. Guides, signal and raw: see svgf.cl.

#define LARGEST_VARIANCE 1e36f  // sums of squares stay finite below it

// What a frame says of VW pixels. All but the depth is 0 where they are not valid, and that is +infinity.
typedef struct {
  vi valid;
  vf depth, normal[3];       // of unit length
  vf light[6], variance[2];  // of luminance
} Pixels;

// Luminance's standard deviation is at most the sum of the channels' weighted ones (equal if they are fully
// correlated, which a path tracer's nearly are). Squared. `inverse`: of the albedo.
INLINE vf luminance_variance(const vf* variance, const vf* inverse) {
  const vf deviation = luminance(sqrt(variance[0]) * inverse[0], sqrt(variance[1]) * inverse[1],
                                 sqrt(variance[2]) * inverse[2]);
  const vf squared = deviation * deviation;
  return squared < (vf)LARGEST_VARIANCE ? squared : (vf)LARGEST_VARIANCE;
}

// Of the pixels whose input begins at `in`, of which n are ours.
INLINE Pixels pixels_at(global const float* in, size_t area, int n) {
  Pixels s;
  vf variance[6], inverse[3], norm = 0.0f;
  s.depth = load_first(in + IN_DEPTH * area, n, INFINITY);
  s.valid = ordinary(s.depth) & (s.depth < (vf)SKY);
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
    const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
    s.normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
    s.valid &= ordinary(emission) & ordinary(albedo) & ordinary(s.normal[c]);
    inverse[c] = 1.0f / albedo_floored(albedo);
    norm = fma(s.normal[c], s.normal[c], norm);
  }
#pragma unroll
  for (int c = 0; c < 6; ++c) {
    s.light[c] = load_first(in + (IN_DIRECT + c) * area, n, 0.0f);
    variance[c] = load_first(in + (IN_DIRECT_VARIANCE + c) * area, n, 0.0f);
    s.valid &= ordinary(s.light[c]) & (variance[c] >= (vf)0.0f) & (variance[c] <= (vf)INFINITY);
  }
  const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
  s.depth = s.valid ? s.depth : (vf)INFINITY;
#pragma unroll
  for (int c = 0; c < 6; ++c) s.light[c] = s.valid ? s.light[c] * inverse[c % 3] : (vf)0.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) s.normal[c] = s.valid ? s.normal[c] * scale : (vf)0.0f;
#pragma unroll
  for (int c = 0; c < 2; ++c)
    s.variance[c] = s.valid ? luminance_variance(variance + 3 * c, inverse) : (vf)0.0f;
  return s;
}

INLINE void store_guides(const Pixels* s, global float* guides, long plane, size_t p) {
  store(s->depth, guides + p);
#pragma unroll
  for (int c = 0; c < 3; ++c) store(s->normal[c], guides + (1 + c) * plane + p);
}

// Of a single frame. With a history svgf_accumulate takes its place.
kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict signal, global float* restrict raw, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    const Pixels s = pixels_at(input + (size_t)y * w + x, area, w - x);
    const size_t p = origin + (size_t)y * stride + x;
    store_guides(&s, guides, plane, p);
#pragma unroll
    for (int c = 0; c < 6; ++c) store(s.light[c], signal + c * plane + p);
#pragma unroll
    for (int c = 0; c < 2; ++c) store(s.variance[c], raw + (6 + c) * plane + p);
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict guides,
                   global const float* restrict signal, int stride, long plane, long origin, int x0, int y0, int x1,
                   int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    global const float* in = input + (size_t)y * w + x;
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(guides + p) < (vf)INFINITY;
    for (int c = 0; c < 3; ++c) {
      const vf direct = load_first(in + (IN_DIRECT + c) * area, n, 0.0f), indirect = load_first(in + (IN_INDIRECT + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf light = load(signal + c * plane + p) + load(signal + (3 + c) * plane + p);
      const vf color = direct + indirect + emission;
      const vf kept = fabs(color) < (vf)INFINITY ? color : (vf)0.0f;
      store_first(valid ? light * albedo_floored(albedo) + emission : kept,
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
