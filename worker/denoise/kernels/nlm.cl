// SPDX-License-Identifier: Apache-2.0
// Non-local means with the distance of Rousselle et al. 2012 (section 4): for signals u of variance V,
//   d2(p, q) = [(u_p - u_q)^2 - alpha (V_p + min(V_p, V_q))] / (epsilon + k^2 (V_p + V_q)),
// averaged over the channels and over the pairs of valid pixels of two (2 NLM_PATCH + 1)^2 patches; the
// weight is exp(-max(0, d2)). With two halves the weights that one yields filter the other.
//   valid:  0, or +infinity at pixels that are no neighbours and in the pads
//   signal: of each half NLM_CHANNELS planes of u, then as many of W = alpha V + epsilon alpha / (2 k^2)
// With a = alpha / k^2, D = W_p + W_q, s = (u_p - u_q)^2 + epsilon a and e = W_q - W_p the quotient is
// a (s + max(e, 0)) / D - a, and that of (q, p) a (s + max(e, 0) - e) / D - a: both share all but an
// addition.
#define NLM_MAPS (2 * NLM_HALVES)  // of each half: distance to the pixel at +o, distance of that one to this

// One reciprocal serves both halves: W is at most 1e18, so the product is finite.
void nlm_reciprocals(const vf* d, vf* r) {
#if NLM_HALVES == 2
  const vf both = nlm_reciprocal(d[0] * d[1]);
  r[0] = both * d[1];
  r[1] = both * d[0];
#else
  r[0] = nlm_reciprocal(d[0]);
#endif
}

// Sums over the channels of (s + max(e, 0)) / D at p for the pair (p, q), and of what (q, p) has in its
// place.
NLM_INLINE void nlm_quotients(global const float* signal, long plane, size_t q,
                              vf u[NLM_HALVES][NLM_CHANNELS], vf w[NLM_HALVES][NLM_CHANNELS], float epsilon,
                              vf* there, vf* back) {
  vf skew[NLM_HALVES];
#pragma unroll
  for (int c = 0; c < NLM_CHANNELS; ++c) {
    vf n[NLM_HALVES], d[NLM_HALVES], e[NLM_HALVES], r[NLM_HALVES];
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h) {
      global const float* at = signal + (2 * h * NLM_CHANNELS + c) * plane + q;
      const vf difference = nlm_load(at) - u[h][c], wq = nlm_load(at + NLM_CHANNELS * plane);
      d[h] = w[h][c] + wq;
      e[h] = wq - w[h][c];
      n[h] = fma(difference, difference, (vf)epsilon) + (e[h] > (vf)0.0f ? e[h] : (vf)0.0f);
    }
    nlm_reciprocals(d, r);
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h) {
      there[h] = c == 0 ? n[h] * r[h] : fma(n[h], r[h], there[h]);
      skew[h] = c == 0 ? e[h] * r[h] : fma(e[h], r[h], skew[h]);
    }
  }
  for (int h = 0; h < NLM_HALVES; ++h) back[h] = there[h] - skew[h];
}

// Down the vector of pixels at column `i` of the maps. sums: NLM_MAPS maps for each offset; then, of a tile
// that is not `whole` (some pixel in reach is not valid), for each offset one that counts pairs of valid
// pixels.
NLM_INLINE void nlm_down(global const float* valid, global const float* signal, int stride, long plane,
                         long origin, NlmTile t, int i, float epsilon, global float* sums, const int whole) {
  vf ring[NLM_GROUP][NLM_MAPS + 1][NLM_RING];
  const long map = (long)t.width * t.height;
  size_t p = origin + (long)(t.above - NLM_PATCH) * stride + t.left + i;
#pragma nounroll
  for (int y = 0; y < t.height + 2 * NLM_PATCH; ++y, p += stride) {
    vf u[NLM_HALVES][NLM_CHANNELS], w[NLM_HALVES][NLM_CHANNELS];
    for (int h = 0; h < NLM_HALVES; ++h)
      for (int c = 0; c < NLM_CHANNELS; ++c) {
        u[h][c] = nlm_load(signal + (2 * h * NLM_CHANNELS + c) * plane + p);
        w[h][c] = nlm_load(signal + ((2 * h + 1) * NLM_CHANNELS + c) * plane + p);
      }
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g) {
      const size_t q = p + (long)t.dy * stride + t.dx + g;
      vf quotient[NLM_MAPS + 1];
      nlm_quotients(signal, plane, q, u, w, epsilon, quotient, quotient + NLM_HALVES);
      if (!whole) {
        const vi pair = (nlm_load(valid + p) < (vf)INFINITY) & (nlm_load(valid + q) < (vf)INFINITY);
        for (int m = 0; m < NLM_MAPS; ++m) quotient[m] = pair ? quotient[m] : (vf)0.0f;
        quotient[NLM_MAPS] = pair ? (vf)1.0f : (vf)0.0f;
      }
#pragma unroll
      for (int m = 0; m < NLM_MAPS + 1; ++m)
        if (m < NLM_MAPS || !whole) ring[g][m][y & (NLM_RING - 1)] = quotient[m];
      if (y < 2 * NLM_PATCH) continue;
#pragma unroll
      for (int m = 0; m < NLM_MAPS + 1; ++m) {
        if (m == NLM_MAPS && whole) continue;
        const vf sum = nlm_ring_sum(ring[g][m], y);
        store(sum, sums + (g * (NLM_MAPS + 1) + m) * map + (long)(y - 2 * NLM_PATCH) * t.width + i);
      }
    }
  }
}

// k: a log2(e), which also is the scale of the mean quotient; that scale over the number of a whole patch's
// quotients; the threshold of weights; epsilon a.
vf nlm_weight(vf sum, vf scale, float4 k) {
  const vf t = fma(sum, -scale, (vf)k.x);
  const vf w = exp2_of_negative(t < (vf)0.0f ? t : (vf)0.0f);
#if NLM_SOFT
  const vf less = w - k.z;
  return less > (vf)0.0f ? less : (vf)0.0f;
#else
  return w < (vf)k.z ? (vf)0.0f : w;
#endif
}

// Adds what the offsets of the group give to the vector of pixels at (i, row) of the tile. acc: of each half
// the sum of weights, then of each channel that of weighted differences.
NLM_INLINE void nlm_gather(global const float* valid, global const float* signal, int stride, long plane,
                           long origin, NlmTile t, int i, int row, float4 k, global const float* sums,
                           global float* acc, const int whole) {
  const size_t p = origin + (long)(t.y + row) * stride + t.x + i;
  const long map = (long)t.width * t.height, area = (long)t.columns * t.rows;
  vf centre[NLM_HALVES][NLM_CHANNELS], total[NLM_HALVES][NLM_CHANNELS + 1];
  for (int h = 0; h < NLM_HALVES; ++h) {
    for (int c = 0; c < NLM_CHANNELS; ++c)
      centre[h][c] = nlm_load(signal + (2 * h * NLM_CHANNELS + c) * plane + p);
    for (int c = 0; c <= NLM_CHANNELS; ++c)
      total[h][c] = nlm_load(acc + (h * (NLM_CHANNELS + 1) + c) * area + (long)row * t.columns + i);
  }
#pragma nounroll
  for (int g = 0; g < t.offsets; ++g)
#pragma unroll
    for (int back = 0; back < 2; ++back) {
      const size_t q = p + nlm_step(t, stride, g, back);
      global const float* here = sums + (long)g * (NLM_MAPS + 1) * map + nlm_site(t, i, row, g, back);
      vf scale = k.y, one = 1.0f;
      if (!whole) {
        const vf count = nlm_across(here + NLM_MAPS * map);
        scale = count == (vf)(float)NLM_FULL ? (vf)k.y : (vf)k.x / ((float)NLM_CHANNELS * count);
        one = nlm_load(valid + q) < (vf)INFINITY ? (vf)1.0f : (vf)0.0f;
      }
#pragma unroll
      for (int h = 0; h < NLM_HALVES; ++h) {
        vf w = nlm_weight(nlm_across(here + (back * NLM_HALVES + h) * map), scale, k);
        if (!whole) w = one > (vf)0.0f ? w : (vf)0.0f;
        const int other = NLM_HALVES - 1 - h;
        total[other][0] += w;
#pragma unroll
        for (int c = 0; c < NLM_CHANNELS; ++c)
          total[other][1 + c] =
              fma(w, nlm_load(signal + (2 * other * NLM_CHANNELS + c) * plane + q) - centre[other][c],
                  total[other][1 + c]);
      }
    }
  for (int h = 0; h < NLM_HALVES; ++h)
    for (int c = 0; c <= NLM_CHANNELS; ++c)
      store(total[h][c], acc + (h * (NLM_CHANNELS + 1) + c) * area + (long)row * t.columns + i);
}

// All offsets of one tile.
NLM_INLINE void nlm_tile(global const float* valid, global const float* signal, int stride, long plane,
                         long origin, NlmTile t, float4 k, global float* acc, global float* sums,
                         const int whole) {
  NLM_FOR_EACH_GROUP(t) {
    t = nlm_with_tables(t);
    NLM_FOR_EACH_VECTOR(i, t.width)
    nlm_down(valid, signal, stride, plane, origin, t, i, k.w, sums, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns)
    nlm_gather(valid, signal, stride, plane, origin, t, i, row, k, sums, acc, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
void nlm_store(global const float* valid, global const float* signal, long plane, size_t p,
               global const float* acc, long area, global float* to) {
  const vi is_valid = nlm_load(valid + p) < (vf)INFINITY;
  for (int h = 0; h < NLM_HALVES; ++h) {
    const vf scale = 1.0f / nlm_load(acc + h * (NLM_CHANNELS + 1) * area);
    for (int c = 0; c < NLM_CHANNELS; ++c) {
      const vf u = nlm_load(signal + (2 * h * NLM_CHANNELS + c) * plane + p);
      const vf mean = fma(nlm_load(acc + (h * (NLM_CHANNELS + 1) + 1 + c) * area), scale, u);
      store(is_valid ? mean : (vf)0.0f, to + (h * NLM_CHANNELS + c) * plane + p);
    }
  }
}

// signals, to: what is read begins at plane `first`, what is written (of each half NLM_CHANNELS planes) at
// `first_to`. scratch: `room` floats for each work-group.
kernel void nlm(global const float* restrict valid, global const float* restrict signals, int first,
                global float* restrict to, int first_to, int stride, long plane, long origin, int x0, int y0,
                int x1, int y1, int columns, int rows, global float* restrict scratch, int room, float4 k) {
  global const float* signal = signals + (long)first * plane;
  global float* acc = scratch + (long)nlm_group() * room;
  for (int n = nlm_group(); n < nlm_tiles(x0, y0, x1, y1, columns, rows); n += nlm_groups()) {
    const NlmTile t = nlm_tile_of(n, x0, y0, x1, y1, columns, rows);
    const long area = (long)t.columns * t.rows;
    const int planes = NLM_HALVES * (NLM_CHANNELS + 1);
    for (int h = 0; h < planes; ++h)  // the pixel itself has weight 1
      NLM_FOR_EACH_VECTOR(i, area) store((vf)(h % (NLM_CHANNELS + 1) == 0 ? 1.0f : 0.0f), acc + h * area + i);
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (nlm_is_whole(valid, stride, origin, t))
      nlm_tile(valid, signal, stride, plane, origin, t, k, acc, acc + planes * area, 1);
    else
      nlm_tile(valid, signal, stride, plane, origin, t, k, acc, acc + planes * area, 0);
    for (int row = 0; row < t.rows; ++row) NLM_FOR_EACH_VECTOR(i, t.columns)
    nlm_store(valid, signal, plane, origin + (long)(t.y + row) * stride + t.x + i,
              acc + (long)row * t.columns + i, area, to + (long)first_to * plane);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
