// SPDX-License-Identifier: Apache-2.0
// Nonlinearly weighted first-order regression (Bitterli et al. 2016): what comes before and between the regressions.
// Behind patches.cl and nfor_regression.cl.
//   base:     0 validity   1..3 colour   4..6 its variance
//   halves:   0..2 colour of half A   3..5 of half B   6..8 the variance of either
//   features, of halves A and B: 0..6, 7..13: albedo, normal, depth   variances of either: 14..20
//   filtered: narrow k: 0..2 half A   3..5 half B   wide k: 6..8, 9..11
//   errors:   0 of the narrow k   1 of the wide one   2 where the wide one is better: 1, else 0

#define LARGEST_VARIANCE 1e30f
#define LARGEST_ERROR 1e30f

// What a half says of a channel; the whole's mean where the half says nothing.
INLINE vf half_or(vf part, vf whole, vi present) {
  const vi told = present & (part < (vf)SKY);
  return told ? part : whole;
}

// Of one channel: both halves, and the variance of a half's mean. Tells whether all of it is ordinary.
INLINE vi take_channel(global const float* in, size_t area, int n, int mean, int variance, int a, int b, float scale,
                       vi in_a, vi in_b, vf* half_a, vf* half_b, vf* spread) {
  const vf m = load_first(in + mean * area, n, 0.0f), v = load_first(in + variance * area, n, 0.0f);
  const vf first = load_first(in + a * area, n, 0.0f), second = load_first(in + b * area, n, 0.0f);
  const vf twice = 2.0f * v * scale * scale;
  *half_a = scale * half_or(first, m, in_a);
  *half_b = scale * half_or(second, m, in_b);
  *spread = twice < (vf)LARGEST_VARIANCE ? twice : (vf)LARGEST_VARIANCE;
  return ordinary(m) & ordinary(first) & ordinary(second) & (v >= (vf)0.0f) & (v <= (vf)INFINITY);
}

kernel void prepare(global const float* restrict input, int w, int h, float depth_scale, global float* restrict base,
                    global float* restrict halves, global float* restrict raw, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    const vf count_a = load_first(in + IN_SAMPLES_A * area, n, 0.0f);
    const vf count_b = load_first(in + IN_SAMPLES_B * area, n, 0.0f);
    const vi in_a = count_a > (vf)0.0f, in_b = count_b > (vf)0.0f;
    vi valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(count_a) & ordinary(count_b);
    vf color[3], a[3 + FEATURES], b[3 + FEATURES], spread[3 + FEATURES];
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      valid &= take_channel(in, area, n, IN_COLOR + c, IN_COLOR_VARIANCE + c, IN_COLOR_A + c, IN_COLOR_B + c, 1.0f, in_a,
                            in_b, a + c, b + c, spread + c);
      valid &= take_channel(in, area, n, IN_ALBEDO + c, IN_ALBEDO_VARIANCE + c, IN_ALBEDO_A + c, IN_ALBEDO_B + c, 1.0f,
                            in_a, in_b, a + 3 + c, b + 3 + c, spread + 3 + c);
      valid &= take_channel(in, area, n, IN_N + c, IN_N_VARIANCE + c, IN_N_A + c, IN_N_B + c, 1.0f, in_a, in_b,
                            a + 6 + c, b + 6 + c, spread + 6 + c);
    }
    valid &= take_channel(in, area, n, IN_DEPTH, IN_DEPTH_VARIANCE, IN_DEPTH_A, IN_DEPTH_B, depth_scale, in_a, in_b,
                          a + 9, b + 9, spread + 9);
    put(valid ? (vf)1.0f : (vf)0.0f, base + p);
    for (int c = 0; c < 3; ++c) {
      put(valid ? color[c] : (vf)0.0f, base + (1 + c) * plane + p);
      put(valid ? 0.5f * spread[c] : (vf)0.0f, base + (4 + c) * plane + p);
      put(valid ? a[c] : (vf)0.0f, halves + c * plane + p);
      put(valid ? b[c] : (vf)0.0f, halves + (3 + c) * plane + p);
      put(valid ? spread[c] : (vf)0.0f, halves + (6 + c) * plane + p);
    }
    for (int f = 0; f < FEATURES; ++f) {
      put(valid ? a[3 + f] : (vf)0.0f, raw + f * plane + p);
      put(valid ? b[3 + f] : (vf)0.0f, raw + (FEATURES + f) * plane + p);
      put(valid ? spread[3 + f] : (vf)0.0f, raw + (2 * FEATURES + f) * plane + p);
    }
  }
}

INLINE void filter_feature(Chunk c, Scratch s, int rows, int window, int channels, global const float* valid,
                           global const float* guide, global const float* variance, global const float* from,
                           global float* to, int stride, long plane) {
  const Guide g = {valid, guide, variance, plane, stride, channels, 0.25f, 1e-7f, 1e4f};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, window, 3, channels, from, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf scale = 1.0f / fetch(sum);
      const vi ours = fetch(valid + p) > (vf)0.0f;
      for (int k = 0; k < channels; ++k)
        put(ours ? fma(fetch(sum + (1 + k) * chunk_size(rows)), scale, fetch(from + k * plane + p)) : (vf)0.0f,
            to + k * plane + p);
    }
}

// Each feature by non-local means with weights of its own (section 5.1), k = 1/2: weights from one half filter the other.
kernel void nfor_features(global const float* restrict valid, global const float* raw, int guide_at, int variance_at,
                          int from_at, global float* restrict to, int to_at, int stride, long plane, long origin, int x0,
                          int y0, int x1, int y1, int rows, global float* restrict scratch, int window) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  global const float *guide = raw + guide_at * plane, *variance = raw + variance_at * plane, *from = raw + from_at * plane;
  global float* out = to + to_at * plane;
  filter_feature(c, s, rows, window, 3, valid, guide, variance, from, out, stride, plane);
  filter_feature(c, s, rows, window, 3, valid, guide + 3 * plane, variance + 3 * plane, from + 3 * plane, out + 3 * plane,
                 stride, plane);
  filter_feature(c, s, rows, window, 1, valid, guide + 6 * plane, variance + 6 * plane, from + 6 * plane, out + 6 * plane,
                 stride, plane);
}

// The mean of two planes, and a quarter of their squared difference: the variance of the mean.
INLINE void combine(vf a, vf b, global float* mean, global float* variance) {
  const vf half_apart = 0.5f * (b - a);
  put(fma((vf)0.5f, b - a, a), mean);
  put(least_of(half_apart * half_apart, (vf)LARGEST_VARIANCE), variance);
}

// combined: 0..6 means of the halves' features   7..13 their variances
kernel void nfor_combine(global const float* restrict features, global float* restrict combined, int stride, long plane,
                         long origin, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    for (int f = 0; f < FEATURES; ++f)
      combine(fetch(features + f * plane + p), fetch(features + (FEATURES + f) * plane + p), combined + f * plane + p,
              combined + (FEATURES + f) * plane + p);
  }
}
