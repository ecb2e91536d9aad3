// SPDX-License-Identifier: Apache-2.0
// Collaborative regression (Bitterli et al. 2016, section 5.2). Behind patches.cl.
//   Each pixel q fits a plane over its window, by non-local means weights: y_q + beta . (1, dx, dy, f - f_q). Each pixel
//   p then averages what the planes of the pixels around say of it, by the weights they gave it: a sum over q, gathered.
//   Coefficients: of each channel 10: constant, dx / R, dy / R, seven features.

#define FEATURES 7
#define SLOPES (FEATURES + 2)
#define PRODUCTS (SLOPES * (SLOPES + 1) / 2)
// Sums over a window: of weights; of columns; of their products; of the light's differences, and those times columns.
#define AT_COLUMNS 1
#define AT_PRODUCTS (AT_COLUMNS + SLOPES)
#define AT_LIGHT (AT_PRODUCTS + PRODUCTS)
#define SUMS (AT_LIGHT + 3 * (1 + SLOPES))
#define COEFFICIENTS (1 + SLOPES)

// Solves the window's normal equations about its weighted means: slopes (C + ridge diag C + least I)^-1 c. C's rounding
// is some 1e-6 of its diagonal, so that the ridge keeps the factors far from it; a column that hardly varies gets no
// slope.
INLINE void solve(const vf* sums, vf* beta) {
  const vf scale = 1.0f / sums[0];
  vf mean[SLOPES], l[PRODUCTS], inverse[SLOPES];
#pragma unroll
  for (int a = 0; a < SLOPES; ++a) mean[a] = sums[AT_COLUMNS + a] * scale;
#pragma unroll
  for (int a = 0; a < SLOPES; ++a) {
#pragma unroll
    for (int b = 0; b <= a; ++b) {
      vf c = fma(sums[AT_PRODUCTS + a * (a + 1) / 2 + b], scale, -mean[a] * mean[b]);
      if (a == b) c = fma(most_of(c, (vf)0.0f), (vf)(1.0f + RIDGE), (vf)LEAST_VARIANCE);
#pragma unroll
      for (int k = 0; k < b; ++k) c = fma(-l[a * (a + 1) / 2 + k], l[b * (b + 1) / 2 + k], c);
      if (a == b) {
        c = sqrt(most_of(c, (vf)(0.5f * LEAST_VARIANCE)));
        inverse[a] = 1.0f / c;
      } else {
        c *= inverse[b];
      }
      l[a * (a + 1) / 2 + b] = c;
    }
  }
#pragma unroll
  for (int channel = 0; channel < 3; ++channel) {
    const vf* light = sums + AT_LIGHT + channel * (1 + SLOPES);
    vf* slopes = beta + channel * COEFFICIENTS + 1;
    const vf level = light[0] * scale;
#pragma unroll
    for (int a = 0; a < SLOPES; ++a) {
      vf c = fma(light[1 + a], scale, -mean[a] * level);
#pragma unroll
      for (int k = 0; k < a; ++k) c = fma(-l[a * (a + 1) / 2 + k], slopes[k], c);
      slopes[a] = c * inverse[a];
    }
#pragma unroll
    for (int a = SLOPES - 1; a >= 0; --a) {
      vf c = slopes[a];
#pragma unroll
      for (int k = a + 1; k < SLOPES; ++k) c = fma(-l[k * (k + 1) / 2 + a], slopes[k], c);
      slopes[a] = c * inverse[a];
    }
    vf offset = level;
#pragma unroll
    for (int a = 0; a < SLOPES; ++a) offset = fma(-slopes[a], mean[a], offset);
    beta[channel * COEFFICIENTS] = offset;
  }
}

// Adds to `sums` what the offsets (i, j) .. (i + count - 1, j) give whose distances are held.
INLINE void add_taps(Guide g, Scratch s, size_t size, size_t at, size_t p, int i, int j, int count, int window,
                     global const float* features, global const float* picture, vf* sums) {
  const float step = 1.0f / (float)window;
#pragma nounroll
  for (int k = 0; k < count; ++k) {
    const size_t q = p + (long)j * g.stride + i + k;
    const vf w = weight_of(fetch(s.rest + k * size + at), fetch(g.valid + q));
    vf x[SLOPES];
    x[0] = (float)(i + k) * step;
    x[1] = (float)j * step;
#pragma unroll
    for (int f = 0; f < FEATURES; ++f) x[2 + f] = fetch(features + f * g.plane + q) - fetch(features + f * g.plane + p);
    sums[0] += w;
#pragma unroll
    for (int a = 0; a < SLOPES; ++a) {
      const vf weighted = w * x[a];
      sums[AT_COLUMNS + a] += weighted;
#pragma unroll
      for (int b = 0; b <= a; ++b)
        sums[AT_PRODUCTS + a * (a + 1) / 2 + b] = fma(weighted, x[b], sums[AT_PRODUCTS + a * (a + 1) / 2 + b]);
    }
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      const vf light = w * (fetch(picture + c * g.plane + q) - fetch(picture + c * g.plane + p));
      vf* to = sums + AT_LIGHT + c * (1 + SLOPES);
      to[0] += light;
#pragma unroll
      for (int a = 0; a < SLOPES; ++a) to[1 + a] = fma(light, x[a], to[1 + a]);
    }
  }
}

kernel void nfor_fit(global const float* restrict valid, global const float* restrict guide, int guide_at,
                     global const float* restrict variance, int variance_at, global const float* restrict features,
                     int features_at, global const float* restrict picture, int picture_at,
                     global float* restrict coefficients, int stride, long plane, long origin, int x0, int y0, int x1,
                     int y1, int rows, global float* restrict scratch, int window, float k2) {
  ALIGNED_FRAME;
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {valid, guide + guide_at * plane, variance + variance_at * plane, plane, stride, 3, k2, 1e-7f, 1e4f};
  const size_t size = chunk_size(rows);
  const int plain = is_plain(valid, stride, c, window + 3);
  global float* kept = s.rest + OFFSETS * size;
  clear(kept, SUMS * size);
  for (int j = -window; j <= window; ++j)
    for (int i = -window; i <= window; i += OFFSETS) {
      const int count = min(OFFSETS, window + 1 - i);
      for (int k = 0; k < count; ++k)
        patch_distances(g, c, s, (long)j * stride + i + k, 3, 0, plain, s.rest + k * size);
      for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; x += VW) {
          const size_t at = (size_t)y * CHUNK_WIDTH + x;
          vf sums[SUMS];
#pragma unroll
          for (int m = 0; m < SUMS; ++m) sums[m] = 0.0f;
          add_taps(g, s, size, at, c.origin + (size_t)y * stride + x, i, j, count, window, features + features_at * plane,
                   picture + picture_at * plane, sums);
#pragma unroll
          for (int m = 0; m < SUMS; ++m) put(fetch(kept + m * size + at) + sums[m], kept + m * size + at);
        }
    }
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t at = (size_t)y * CHUNK_WIDTH + x, p = c.origin + (size_t)y * stride + x;
      vf sums[SUMS], beta[3 * COEFFICIENTS];
#pragma unroll
      for (int m = 0; m < SUMS; ++m) sums[m] = fetch(kept + m * size + at);
      solve(sums, beta);
      const vi ours = fetch(valid + p) > (vf)0.0f;
#pragma unroll
      for (int m = 0; m < 3 * COEFFICIENTS; ++m) put(ours ? beta[m] : (vf)0.0f, coefficients + m * plane + p);
    }
}

// p plus the mean of what the planes around predict above it: a constant picture comes back bit for bit.
kernel void nfor_gather(global const float* restrict valid, global const float* restrict guide, int guide_at,
                        global const float* restrict variance, int variance_at, global const float* restrict features,
                        int features_at, global const float* restrict picture, int picture_at,
                        global const float* restrict coefficients, global float* restrict result, int result_at,
                        int stride, long plane, long origin, int x0, int y0, int x1, int y1, int rows,
                        global float* restrict scratch, int window, float k2) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {valid, guide + guide_at * plane, variance + variance_at * plane, plane, stride, 3, k2, 1e-7f, 1e4f};
  const size_t size = chunk_size(rows);
  const int plain = is_plain(valid, stride, c, window + 3);
  const float step = 1.0f / (float)window;
  global float* sums = s.rest + OFFSETS * size;
  global const float *feature = features + features_at * plane, *light = picture + picture_at * plane;
  clear(sums, 4 * size);
  for (int j = -window; j <= window; ++j)
    for (int i = -window; i <= window; ++i) {
      const long offset = (long)j * stride + i;
      patch_distances(g, c, s, offset, 3, 1, plain, s.rest);
      for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; x += VW) {
          const size_t at = (size_t)y * CHUNK_WIDTH + x, p = c.origin + (size_t)y * stride + x, q = p + offset;
          const vf w = weight_of(fetch(s.rest + at), fetch(valid + q));
          put(fetch(sums + at) + w, sums + at);
#pragma unroll
          for (int k = 0; k < 3; ++k) {
            global const float* beta = coefficients + (size_t)k * COEFFICIENTS * plane + q;
            vf predicted = fetch(light + k * plane + q) - fetch(light + k * plane + p) + fetch(beta);
            predicted = fma(fetch(beta + plane), (vf)(-(float)i * step), predicted);
            predicted = fma(fetch(beta + 2 * plane), (vf)(-(float)j * step), predicted);
#pragma unroll
            for (int f = 0; f < FEATURES; ++f)
              predicted = fma(fetch(beta + (3 + f) * plane),
                              fetch(feature + f * plane + p) - fetch(feature + f * plane + q), predicted);
            global float* sum = sums + (1 + k) * size + at;
            put(fma(w, predicted, fetch(sum)), sum);
          }
        }
    }
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t at = (size_t)y * CHUNK_WIDTH + x, p = c.origin + (size_t)y * stride + x;
      const vf scale = 1.0f / fetch(sums + at);
      const vi ours = fetch(valid + p) > (vf)0.0f;
      for (int k = 0; k < 3; ++k) {
        const vf y_p = fetch(light + k * plane + p), v = fma(fetch(sums + (1 + k) * size + at), scale, y_p);
        // Light beyond what squares fit into a float is left alone.
        const vf finite = fabs(v) <= (vf)LARGEST ? v : y_p;
        put(ours ? finite : (vf)0.0f, result + (result_at + k) * plane + p);
      }
    }
}
