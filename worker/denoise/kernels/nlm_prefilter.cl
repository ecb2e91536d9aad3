// SPDX-License-Identifier: Apache-2.0
// The non-local mean by which the Feature Distance Filter smooths a scalar (Lardinoije, section 4.2): weights
// are the mean over the patches' pairs of pixels of exp(-(u_p - u_q)^2 / (epsilon + V_p + V_q)), so that one
// pixel that agrees is enough for a small weight.
//   valid:  0, or +infinity at pixels that are no neighbours and in the pads
//   signal: a plane of u, one of V + epsilon / 2
// Both directions of a pair have one weight.

// Down the vector of pixels at column `i` of the tables. sums: for each offset one of sums of exponentials,
// one of counts of pairs, which a `whole` tile does not need.
NLM_INLINE void nlm_prefilter_down(global const float* valid, global const float* signal, int stride,
                                   long plane, long origin, NlmTile t, int i, global float* sums,
                                   const int whole) {
  vf ring[NLM_GROUP][2][NLM_RING];
  const long table = (long)t.width * t.height;
  size_t p = origin + (long)(t.above - NLM_PATCH) * stride + t.left + i;
#pragma nounroll
  for (int y = 0; y < t.height + 2 * NLM_PATCH; ++y, p += stride) {
    const vf u = nlm_load(signal + p), v = nlm_load(signal + plane + p);
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g) {
      const size_t q = p + nlm_step(t, stride, g, 0);
      const vf difference = nlm_load(signal + q) - u;
      const vf reciprocal = nlm_reciprocal(v + nlm_load(signal + plane + q));
      vf weight[2];
      weight[0] = exp2_of_negative(difference * (difference * -LOG2_E) * reciprocal);
      if (!whole) {
        const vi pair = (nlm_load(valid + p) < (vf)INFINITY) & (nlm_load(valid + q) < (vf)INFINITY);
        weight[0] = pair ? weight[0] : (vf)0.0f;
        weight[1] = pair ? (vf)1.0f : (vf)0.0f;
      }
#pragma unroll
      for (int m = 0; m < 2; ++m) {
        if (m == 1 && whole) continue;
        ring[g][m][y & (NLM_RING - 1)] = weight[m];
        if (y < 2 * NLM_PATCH) continue;
        const vf sum = nlm_ring_sum(ring[g][m], y);
        store(sum, sums + (2 * g + m) * table + (long)(y - 2 * NLM_PATCH) * t.width + i);
      }
    }
  }
}

// Adds what the offsets of the group give to the vector of pixels at (i, row) of the tile. Weights count
// NLM_FULL times. acc: the sum of weights, then that of weighted differences.
NLM_INLINE void nlm_prefilter_gather(global const float* valid, global const float* signal, int stride,
                                     long origin, NlmTile t, int i, int row, global const float* sums,
                                     global float* acc, const int whole) {
  const size_t p = origin + (long)(t.y + row) * stride + t.x + i;
  const long table = (long)t.width * t.height, area = (long)t.columns * t.rows;
  acc += (long)row * t.columns + i;
  const vf centre = nlm_load(signal + p);
  vf total = nlm_load(acc), mean = nlm_load(acc + area);
#pragma nounroll
  for (int g = 0; g < t.offsets; ++g)
#pragma unroll
    for (int back = 0; back < 2; ++back) {
      const size_t q = p + nlm_step(t, stride, g, back);
      global const float* here = sums + 2 * g * table + nlm_site(t, i, row, g, back);
      vf weight = nlm_across(here);
      if (!whole) {
        const vf count = nlm_across(here + table);
        weight *= count == (vf)(float)NLM_FULL ? (vf)1.0f : (float)NLM_FULL / count;
        weight = nlm_load(valid + q) < (vf)INFINITY ? weight : (vf)0.0f;
      }
      total += weight;
      mean = fma(weight, nlm_load(signal + q) - centre, mean);
    }
  store(total, acc);
  store(mean, acc + area);
}

// All offsets of one tile.
NLM_INLINE void nlm_prefilter_tile(global const float* valid, global const float* signal, int stride,
                                   long plane, long origin, NlmTile t, global float* acc, global float* sums,
                                   const int whole) {
  NLM_FOR_EACH_GROUP(t) {
    t = nlm_with_tables(t);
    NLM_FOR_EACH_VECTOR(i, t.width)
    nlm_prefilter_down(valid, signal, stride, plane, origin, t, i, sums, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns)
    nlm_prefilter_gather(valid, signal, stride, origin, t, i, row, sums, acc, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// signals, to: what is read begins at plane `first`, the plane that is written is `first_to`. scratch: `room`
// floats for each work-group.
kernel void nlm_mean_of_exp(global const float* restrict valid, global const float* restrict signals,
                            int first, global float* restrict to, int first_to, int stride, long plane,
                            long origin, int x0, int y0, int x1, int y1, int columns, int rows,
                            global float* restrict scratch, int room) {
  global const float* signal = signals + (long)first * plane;
  global float* acc = scratch + (long)nlm_group() * room;
  for (int n = nlm_group(); n < nlm_tiles(x0, y0, x1, y1, columns, rows); n += nlm_groups()) {
    const NlmTile t = nlm_tile_of(n, x0, y0, x1, y1, columns, rows);
    const long area = (long)t.columns * t.rows;
    NLM_FOR_EACH_VECTOR(i, area) {
      store((vf)(float)NLM_FULL, acc + i);  // the pixel itself has weight 1
      store((vf)0.0f, acc + area + i);
    }
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (nlm_is_whole(valid, stride, origin, t))
      nlm_prefilter_tile(valid, signal, stride, plane, origin, t, acc, acc + 2 * area, 1);
    else
      nlm_prefilter_tile(valid, signal, stride, plane, origin, t, acc, acc + 2 * area, 0);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns) {
        const size_t p = origin + (long)(t.y + row) * stride + t.x + i;
        global const float* total = acc + (long)row * t.columns + i;
        // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
        const vf result = nlm_load(signal + p) + nlm_load(total + area) / nlm_load(total);
        store(nlm_load(valid + p) < (vf)INFINITY ? result : (vf)0.0f, to + (long)first_to * plane + p);
      }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
