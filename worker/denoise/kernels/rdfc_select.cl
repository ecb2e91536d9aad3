// SPDX-License-Identifier: Apache-2.0
// Which of the three candidates is taken where (Rousselle et al. 2013, section 5). Behind rdfc.cl.

// Errors smoothed by the colours' patches; the least is marked. The first of equal ones.
kernel void rdfc_errors(global const float* restrict base, global float* restrict errors, int stride, long plane,
                        long origin, int x0, int y0, int x1, int y1, int rows, global float* restrict scratch) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {base, base + plane, base + 4 * plane, plane, stride, 3, 1.0f, 1e-10f, INFINITY};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, ERROR_WINDOW, 3, 3, errors, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf scale = 1.0f / fetch(sum);
      vf error[3];
      for (int k = 0; k < 3; ++k)
        error[k] = fma(fetch(sum + (1 + k) * chunk_size(rows)), scale, fetch(errors + k * plane + p));
      const vi valid = fetch(base + p) > (vf)0.0f;
      const vi second = valid & (error[1] < error[0]) & (error[1] <= error[2]);
      const vi third = valid & (error[2] < error[0]) & (error[2] < error[1]);
      put(second ? (vf)1.0f : (vf)0.0f, errors + 4 * plane + p);
      put(third ? (vf)1.0f : (vf)0.0f, errors + 5 * plane + p);
    }
}

// The marks smoothed likewise are the candidates' shares. The result replaces the first candidate.
kernel void rdfc_blend(global const float* restrict base, global const float* restrict errors,
                       global float* restrict candidates, int stride, long plane, long origin, int x0, int y0, int x1,
                       int y1, int rows, global float* restrict scratch) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {base, base + plane, base + 4 * plane, plane, stride, 3, 1.0f, 1e-10f, INFINITY};
  global float* sums = s.rest + chunk_size(rows);
  smooth(g, c, s, rows, SELECTION_WINDOW, 3, 2, errors + 4 * plane, sums);
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float* sum = sums + (size_t)y * CHUNK_WIDTH + x;
      const vf scale = 1.0f / fetch(sum);
      const vi valid = fetch(base + p) > (vf)0.0f;
      const vf second = fma(fetch(sum + chunk_size(rows)), scale, fetch(errors + 4 * plane + p));
      const vf third = fma(fetch(sum + 2 * chunk_size(rows)), scale, fetch(errors + 5 * plane + p));
      for (int k = 0; k < 3; ++k) {
        global float* first = candidates + k * plane + p;
        const vf v = fetch(first);
        const vf blended = fma(third, fetch(first + 6 * plane) - v, fma(second, fetch(first + 3 * plane) - v, v));
        put(valid ? blended : (vf)0.0f, first);
      }
    }
}
