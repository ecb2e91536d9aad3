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
  vf inverse[3], norm = 0.0f;
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
#ifdef IN_DIRECT_VARIANCE
  vf variance[6];
#endif
#pragma unroll
  for (int c = 0; c < 6; ++c) {
    s.light[c] = load_first(in + (IN_DIRECT + c) * area, n, 0.0f);
    s.valid &= ordinary(s.light[c]);
#ifdef IN_DIRECT_VARIANCE
    variance[c] = load_first(in + (IN_DIRECT_VARIANCE + c) * area, n, 0.0f);
    s.valid &= (variance[c] >= (vf)0.0f) & (variance[c] <= (vf)INFINITY);
#endif
  }
  const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
  s.depth = s.valid ? s.depth : (vf)INFINITY;
#pragma unroll
  for (int c = 0; c < 6; ++c) s.light[c] = s.valid ? s.light[c] * inverse[c % 3] : (vf)0.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) s.normal[c] = s.valid ? s.normal[c] * scale : (vf)0.0f;
#ifdef IN_DIRECT_VARIANCE
#pragma unroll
  for (int c = 0; c < 2; ++c)
    s.variance[c] = s.valid ? luminance_variance(variance + 3 * c, inverse) : (vf)0.0f;
#endif
  return s;
}

INLINE void store_guides(const Pixels* s, global float* guides, long plane, size_t p) {
  store(s->depth, guides + p);
#pragma unroll
  for (int c = 0; c < 3; ++c) store(s->normal[c], guides + (1 + c) * plane + p);
}

// What a frame leaves for the next one: light, from plane 3 of the output on, over [x0, x1) x [y0, y1).
#define KEPT_ARGUMENTS int kept, int kept_x0, int kept_y0, int kept_x1, int kept_y1, global float *restrict output
INLINE void keep_light(const vf* light, KEPT_ARGUMENTS, int x, int y) {
  if (!kept || y < kept_y0 || y >= kept_y1) return;
  const int width = kept_x1 - kept_x0;
  const size_t area = (size_t)width * (kept_y1 - kept_y0);
  global float* out = output + 3 * area + (size_t)(y - kept_y0) * width + (x - kept_x0);
#pragma unroll
  for (int c = 0; c < 6; ++c) store_between(light[c], out + c * area, x, kept_x0, kept_x1);
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
    for (int c = 0; c < 2; ++c) {
#ifdef MOMENTS
      store(luminance(s.light[3 * c], s.light[3 * c + 1], s.light[3 * c + 2]), raw + (6 + c) * plane + p);
#else
      store(s.variance[c], raw + (6 + c) * plane + p);
#endif
    }
  }
}

// RGB of the filtered light of VW pixels whose input begins at `in`, of which n are ours. What is not valid keeps its
// colour.
INLINE void modulated(global const float* in, size_t area, int n, vi valid, const vf* light, vf* rgb) {
  vf emission[3];
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    emission[c] = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
    const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
    rgb[c] = (light[c] + light[3 + c]) * albedo_floored(albedo) + emission[c];
  }
  if (!any_lane(!valid)) return;
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf direct = load_first(in + (IN_DIRECT + c) * area, n, 0.0f);
    const vf color = direct + load_first(in + (IN_INDIRECT + c) * area, n, 0.0f) + emission[c];
    rgb[c] = filtered_or_kept(valid, rgb[c], color);
  }
}
