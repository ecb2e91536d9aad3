// SPDX-License-Identifier: Apache-2.0
// The non-local mean by which the Feature Distance Filter smooths a scalar (Lardinoije, section 4.2): weights
// are the mean over the patches' pairs of pixels of exp(-(u_p - u_q)^2 / (epsilon + V_p + V_q)), so that one
// pixel that agrees is enough for a small weight.
//   valid:  0, or +infinity at pixels that are no neighbours and in the pads
//   signal: a plane of u, one of V + epsilon / 2
// Both directions of a pair have one weight.

#define NLM_PREFILTER_PLANES 3  // of a tile's own copy; the last is `valid`

// Down the vector of pixels at column `i` of the tables. sums: for each offset one of sums of exponentials,
// one of counts of pairs, which a `whole` tile does not need.
NLM_INLINE void nlm_prefilter_down(global const float* own, NlmTile t, int i, global float* sums,
                                   const int whole) {
  NlmRing rings[NLM_GROUP][2];
  const long table = (long)t.width * t.height, row = (long)NLM_PREFILTER_PLANES * t.pitch;
  const int pitch = t.pitch;
  global const float* p = own + nlm_own(t, NLM_PREFILTER_PLANES, t.left + i, t.above - NLM_PATCH);
#pragma nounroll
  for (int y = 0; y < t.height + 2 * NLM_PATCH; ++y, p += row) {
    const vf u = nlm_load(p), v = nlm_load(p + pitch);
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g) {
      global const float* q = p + nlm_step(t, NLM_PREFILTER_PLANES, g, 0);
      const vf difference = nlm_load(q) - u;
      const vf reciprocal = nlm_reciprocal(v + nlm_load(q + pitch));
      vf weight[2];
      vf e = fma(difference * (difference * (-LOG2_E * 8388608.0f)), reciprocal, (vf)OF_ONE);
      weight[0] = number_of(e > (vf)0.0f ? e : (vf)0.0f);
      if (!whole) {
        const vi pair =
            (nlm_load(p + 2 * pitch) < (vf)INFINITY) & (nlm_load(q + 2 * pitch) < (vf)INFINITY);
        weight[0] = pair ? weight[0] : (vf)0.0f;
        weight[1] = pair ? (vf)1.0f : (vf)0.0f;
      }
      global float* to = sums + 2 * g * table + (long)(y - 2 * NLM_PATCH) * t.width + i;
#pragma unroll
      for (int m = 0; m < 2; ++m) {
        if (m == 1 && whole) continue;
        const vf sum = nlm_ring_sum(&rings[g][m], y, weight[m]);
        if (y >= 2 * NLM_PATCH) nlm_save(sum, to + m * table);
      }
    }
  }
}

// Adds what the offsets of the group give to the vector of pixels at (i, row) of the tile. Weights count
// NLM_FULL times. acc: the sum of weights, then that of weighted differences.
NLM_INLINE void nlm_prefilter_gather(global const float* own, NlmTile t, int i, int row,
                                     global const float* sums, global float* acc, const int whole) {
  global const float* p = own + nlm_own(t, NLM_PREFILTER_PLANES, i, row);
  const long table = (long)t.width * t.height, area = (long)t.columns * t.rows;
  acc += (long)row * t.columns + i;
  const vf centre = nlm_load(p);
  vf total = nlm_load(acc), mean = nlm_load(acc + area);
#pragma nounroll
  for (int g = 0; g < t.offsets; ++g)
#pragma unroll
    for (int back = 0; back < 2; ++back) {
      global const float* q = p + nlm_step(t, NLM_PREFILTER_PLANES, g, back);
      global const float* here = sums + 2 * g * table + nlm_site(t, i, row, g, back);
      vf weight = nlm_across(here);
      if (!whole) {
        const vf count = nlm_across(here + table);
        weight *= count == (vf)(float)NLM_FULL ? (vf)1.0f : (float)NLM_FULL * nlm_reciprocal(count);
        weight = nlm_load(q + 2 * t.pitch) < (vf)INFINITY ? weight : (vf)0.0f;
      }
      total += weight;
      mean = fma(weight, nlm_load(q) - centre, mean);
    }
  nlm_save(total, acc);
  nlm_save(mean, acc + area);
}

// All offsets of one tile.
NLM_INLINE void nlm_prefilter_tile(global const float* own, NlmTile t, global float* acc,
                                   global float* sums, const int whole) {
  NLM_FOR_EACH_GROUP(t) {
    t = nlm_with_tables(t);
    NLM_FOR_EACH_VECTOR(i, t.width)
    nlm_prefilter_down(own, t, i, sums, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns)
    nlm_prefilter_gather(own, t, i, row, sums, acc, whole);
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
      nlm_save((vf)(float)NLM_FULL, acc + i);  // the pixel itself has weight 1
      nlm_save((vf)0.0f, acc + area + i);
    }
    global float *own = acc + 2 * area, *sums = own + nlm_own_floats(t, NLM_PREFILTER_PLANES);
    for (int c = 0; c < NLM_PREFILTER_PLANES; ++c)
      nlm_copy(c < 2 ? signal + c * plane : valid, stride, origin, t, NLM_PREFILTER_PLANES, own + c * t.pitch);
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (nlm_is_whole(valid, stride, origin, t))
      nlm_prefilter_tile(own, t, acc, sums, 1);
    else
      nlm_prefilter_tile(own, t, acc, sums, 0);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns) {
        const size_t p = origin + (long)(t.y + row) * stride + t.x + i;
        global const float* total = acc + (long)row * t.columns + i;
        // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
        const vf result = nlm_load(signal + p) + nlm_load(total + area) / nlm_load(total);
        nlm_save(nlm_load(valid + p) < (vf)INFINITY ? result : (vf)0.0f, to + (long)first_to * plane + p);
      }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
