// SPDX-License-Identifier: Apache-2.0
// Robust denoising using feature and colour information (Rousselle, Manzi and Zwicker 2013). Behind patches.cl.
//   base:       0 validity   1..3 colour   4..6 its variance
//   raw:        per feature its channels, then half the difference of the halves: 0..2, 3..5 albedo   6..8, 9..11
//               normal   12, 13 depth; variances: 14..16 albedo   17..19 normal   20 depth
//   features:   filtered: 0..2 albedo   3..5 normal   6 depth; 7..13 their residual variances
//   scales:     1 / (channels k_f^2 max(tau, variance, gradient^2)) of each channel: 0..6 tau   7..13 tau_features
//   candidates: three filtered colours       errors: 0..2 of the candidates   3..5 1 for the best, else 0

#define FEATURES 7
#define LARGEST_VARIANCE 1e30f

// Of one channel of a feature, scaled: its mean, half the halves' difference, the variance of the mean.
INLINE vi take_feature(global const float* in, size_t area, int n, int mean, int variance, int a, int b, float scale, vi apart,
                vf* value, vf* difference, vf* spread) {
  const vf m = load_first(in + mean * area, n, 0.0f), v = load_first(in + variance * area, n, 0.0f);
  const vf first = load_first(in + a * area, n, 0.0f), second = load_first(in + b * area, n, 0.0f);
  apart &= (first < (vf)SKY) & (second < (vf)SKY);
  *value = m * scale;
  *difference = apart ? 0.5f * scale * (first - second) : (vf)0.0f;
  const vf scaled = v * scale * scale;
  *spread = scaled < (vf)LARGEST_VARIANCE ? scaled : (vf)LARGEST_VARIANCE;
  return ordinary(m) & ordinary(first) & ordinary(second) & (v >= (vf)0.0f) & (v <= (vf)INFINITY);
}

// depth_scale: 1 over the depth that counts as 1. Normals count from -1/2 to 1/2, so that tau means the same to all.
kernel void prepare(global const float* restrict input, int w, int h, float depth_scale, global float* restrict base,
                    global float* restrict raw, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    const vf in_a = load_first(in + IN_SAMPLES_A * area, n, 0.0f), in_b = load_first(in + IN_SAMPLES_B * area, n, 0.0f);
    const vi apart = (in_a > (vf)0.0f) & (in_b > (vf)0.0f);
    vi valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(in_a) & ordinary(in_b);
    vf color[3], variance[3], value[FEATURES], difference[FEATURES], spread[FEATURES];
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      variance[c] = load_first(in + (IN_COLOR_VARIANCE + c) * area, n, 0.0f);
      valid &= ordinary(color[c]) & (variance[c] >= (vf)0.0f) & (variance[c] <= (vf)INFINITY);
      valid &= take_feature(in, area, n, IN_ALBEDO + c, IN_ALBEDO_VARIANCE + c, IN_ALBEDO_A + c, IN_ALBEDO_B + c, 1.0f,
                            apart, value + c, difference + c, spread + c);
      valid &= take_feature(in, area, n, IN_N + c, IN_N_VARIANCE + c, IN_N_A + c, IN_N_B + c, 0.5f, apart,
                            value + 3 + c, difference + 3 + c, spread + 3 + c);
    }
    valid &= take_feature(in, area, n, IN_DEPTH, IN_DEPTH_VARIANCE, IN_DEPTH_A, IN_DEPTH_B, depth_scale, apart,
                          value + 6, difference + 6, spread + 6);
    put(valid ? (vf)1.0f : (vf)0.0f, base + p);
    for (int c = 0; c < 3; ++c) {
      put(valid ? color[c] : (vf)0.0f, base + (1 + c) * plane + p);
      put(valid ? least_of(variance[c], (vf)LARGEST_VARIANCE) : (vf)0.0f, base + (4 + c) * plane + p);
    }
    for (int f = 0; f < FEATURES; ++f) {
      const int at = 6 * (f / 3) + f % 3;
      put(valid ? value[f] : (vf)0.0f, raw + at * plane + p);
      put(valid ? difference[f] : (vf)0.0f, raw + (f < 6 ? at + 3 : 13) * plane + p);
      put(valid ? spread[f] : (vf)0.0f, raw + (14 + f) * plane + p);
    }
  }
}

// One feature of `channels`, the first of which is channel `first` of all.
INLINE void filter_feature(Chunk c, Scratch s, int rows, int first, int channels, global const float* base,
                    global const float* raw, global float* features, int stride, long plane) {
  const int at = 2 * first;
  const Guide g = {base, raw + at * plane, raw + (14 + first) * plane, plane, stride, channels, 1.0f, 1e-10f, INFINITY};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, PREFILTER_WINDOW, 3, 2 * channels, g.picture, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf scale = 1.0f / fetch(sum);
      const vi valid = fetch(base + p) > (vf)0.0f;
      for (int k = 0; k < channels; ++k) {
        const vf value = fma(fetch(sum + (1 + k) * chunk_size(rows)), scale, fetch(g.picture + k * plane + p));
        const vf half_apart = fma(fetch(sum + (1 + channels + k) * chunk_size(rows)), scale,
                                  fetch(g.picture + (channels + k) * plane + p));
        const vf spread = least_of(half_apart * half_apart, (vf)LARGEST_VARIANCE);
        put(valid ? value : (vf)0.0f, features + (first + k) * plane + p);
        put(valid ? spread : (vf)0.0f, features + (FEATURES + first + k) * plane + p);
      }
    }
}

// The mean of the filtered halves is the filtered mean, and a quarter of their squared difference its variance.
kernel void rdfc_features(global const float* restrict base, global const float* restrict raw,
                          global float* restrict features, int stride, long plane, long origin, int x0, int y0, int x1,
                          int y1, int rows, global float* restrict scratch) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  filter_feature(c, s, rows, 0, 3, base, raw, features, stride, plane);
  filter_feature(c, s, rows, 3, 3, base, raw, features, stride, plane);
  filter_feature(c, s, rows, 6, 1, base, raw, features, stride, plane);
}

// The smaller of the squared half differences to the neighbours on either side, of those that are valid.
INLINE vf squared_slope(global const float* base, global const float* feature, size_t p, int step) {
  const vf centre = fetch(feature + p);
  const vf back = 0.5f * (centre - fetch(feature + p - step)), ahead = 0.5f * (fetch(feature + p + step) - centre);
  const vf before = fetch(base + p - step) > (vf)0.0f ? back * back : (vf)INFINITY;
  const vf behind = fetch(base + p + step) > (vf)0.0f ? ahead * ahead : (vf)INFINITY;
  const vf least = least_of(before, behind);
  return least < (vf)INFINITY ? least : (vf)0.0f;
}

// k: k_f^2, tau, tau_features. The sum of the scaled excesses of a feature's channels is their mean over
// k_f^2 max(tau, variance, gradient^2): Rousselle et al. 2013, equation 4.
kernel void rdfc_scales(global const float* restrict base, global const float* restrict features,
                        global float* restrict scales, int stride, long plane, long origin, int x0, int y0, int x1,
                        int y1, float4 k) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = fetch(base + p) > (vf)0.0f;
    for (int f = 0; f < FEATURES; ++f) {
      global const float* feature = features + f * plane;
      const vf gradient = squared_slope(base, feature, p, 1) + squared_slope(base, feature, p, stride);
      const vf spread = least_of(most_of(fetch(feature + FEATURES * plane + p), gradient), (vf)LARGEST_VARIANCE);
      const float channels = f < 6 ? 3 : 1;
      put(valid ? 1.0f / (channels * k.x * most_of(spread, (vf)k.y)) : (vf)0.0f, scales + f * plane + p);
      put(valid ? 1.0f / (channels * k.x * most_of(spread, (vf)k.z)) : (vf)0.0f, scales + (FEATURES + f) * plane + p);
    }
  }
}
