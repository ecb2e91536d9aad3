// SPDX-License-Identifier: Apache-2.0
// Which k is taken where (Bitterli et al. 2016, section 5.3). Behind nfor.cl.

INLINE vf kept_finite(vf error) {
  const vf below = error < (vf)LARGEST_ERROR ? error : (vf)LARGEST_ERROR;
  return below > (vf)-LARGEST_ERROR ? below : (vf)-LARGEST_ERROR;
}

// The squared error of the mean of two filtered halves, each held against the other half, whose noise is taken off:
// 1/2 [(B - FA)^2 + (A - FB)^2] - 2 V - 1/4 (FB - FA)^2, the mean over channels. V: of the whole's mean.
kernel void nfor_errors(global const float* restrict base, global const float* restrict halves,
                        global const float* restrict filtered, global float* restrict errors, int stride, long plane,
                        long origin, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vi ours = fetch(base + p) > (vf)0.0f;
    for (int m = 0; m < 2; ++m) {
      vf total = 0.0f;
      for (int c = 0; c < 3; ++c) {
        const vf fa = fetch(filtered + (6 * m + c) * plane + p), fb = fetch(filtered + (6 * m + 3 + c) * plane + p);
        const vf da = fetch(halves + (3 + c) * plane + p) - fa, db = fetch(halves + c * plane + p) - fb, apart = fb - fa;
        const vf twice = fetch(halves + (6 + c) * plane + p);
        total += kept_finite(fma((vf)0.5f, fma(da, da, db * db), -twice) - 0.25f * apart * apart);
      }
      put(ours ? total * (1.0f / 3) : (vf)0.0f, errors + m * plane + p);
    }
  }
}

// Errors smoothed by the colours' small patches; marks where the wide k's is the smaller.
kernel void nfor_compare(global const float* restrict base, global float* restrict errors, int stride, long plane,
                         long origin, int x0, int y0, int x1, int y1, int rows, global float* restrict scratch,
                         int window) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {base, base + plane, base + 4 * plane, plane, stride, 3, 1.0f, 1e-7f, 1e4f};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, window, 1, 2, errors, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf scale = 1.0f / fetch(sum);
      const vf narrow = fma(fetch(sum + chunk_size(rows)), scale, fetch(errors + p));
      const vf wide = fma(fetch(sum + 2 * chunk_size(rows)), scale, fetch(errors + plane + p));
      const vi marked = (fetch(base + p) > (vf)0.0f) & (wide < narrow);
      put(marked ? (vf)1.0f : (vf)0.0f, errors + 2 * plane + p);
    }
}

// The marks smoothed likewise: the share of the wide k. In place of `filtered`: 0..2 the mean of the blended halves,
// 3..5 its variance.
kernel void nfor_blend(global const float* restrict base, global const float* restrict errors,
                       global float* restrict filtered, int stride, long plane, long origin, int x0, int y0, int x1,
                       int y1, int rows, global float* restrict scratch, int window) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {base, base + plane, base + 4 * plane, plane, stride, 3, 1.0f, 1e-7f, 1e4f};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, window, 1, 1, errors + 2 * plane, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf smooth_share = fma(fetch(sum + chunk_size(rows)), 1.0f / fetch(sum), fetch(errors + 2 * plane + p));
      const vf share = fetch(base + p) > (vf)0.0f ? smooth_share : (vf)0.0f;
      for (int k = 0; k < 3; ++k) {
        global float* at = filtered + k * plane + p;
        const vf a = fma(share, fetch(at + 6 * plane) - fetch(at), fetch(at));
        const vf b = fma(share, fetch(at + 9 * plane) - fetch(at + 3 * plane), fetch(at + 3 * plane));
        combine(a, b, at, at + 3 * plane);
      }
    }
}
