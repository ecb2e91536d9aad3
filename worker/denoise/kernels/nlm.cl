// SPDX-License-Identifier: Apache-2.0
// Non-local means with the distance of Rousselle et al. 2012 (section 4): for signals u of variance V,
//   d2(p, q) = [(u_p - u_q)^2 - alpha (V_p + min(V_p, V_q))] / (epsilon + k^2 (V_p + V_q)),
// averaged over the channels and over the pairs of valid pixels of two (2 NLM_PATCH + 1)^2 patches; the
// weight is exp(-max(0, d2)). With two halves the weights that one yields filter the other.
//   valid:  0, or +infinity at pixels that are no neighbours and in the pads
//   signal: of each half NLM_CHANNELS planes of u, then as many of W + epsilon a (below), W = alpha V +
//           epsilon a / 2
// With a = alpha / k^2, D = W_p + W_q, r = 1 / D and n = (u_p - u_q)^2 + epsilon a + max(W_p, W_q) the quotient
// is a (n r - W_p r - 1), and that of (q, p) a (n r - W_q r - 1). As W_p r + W_q r = 1, both follow from sums of
// n r and of W_p r.
//
// First, down the columns of a tile, quotients are summed into tables in the cache; then, row by row, those across. The
// two cases of `whole` are two programs.
#define NLM_PLANES (2 * NLM_HALVES * NLM_CHANNELS + 1)  // of a tile's own copy; the last is `valid`
#define NLM_MAPS (2 * NLM_HALVES)  // of each half: distance to the pixel at +o, distance of that one to this

// Copies a plane; the rest of a row becomes 0.
void nlm_copy(global const float* from, int stride, long origin, NlmTile t, int planes, global float* to) {
  for (int y = -NLM_REACH; y < t.rows + NLM_REACH; ++y, to += planes * t.pitch) {
    global const float* row = from + origin + (long)(t.y + y) * stride + t.x - NLM_REACH;
    FOR_EACH_SHARED(i, t.pitch)
      put(i < t.columns + 2 * NLM_REACH ? fetch(row + i) : (vf)0.0f, to + i);
  }
}

// The last rows of what is summed down a column: themselves, and sums of the last NLM_PATCH.
typedef struct {
  vf rows[NLM_RING], sums[NLM_RING];
} NlmRing;

// Takes what row y has. The sum of the last 2 NLM_PATCH + 1 rows, of which there must have been as many.
INLINE vf nlm_ring_sum(NlmRing* ring, int y, vf row) {
  vf sum = row;
#pragma unroll
  for (int k = 1; k < NLM_PATCH; ++k) sum += ring->rows[(y - k) & (NLM_RING - 1)];
  ring->rows[y & (NLM_RING - 1)] = row;
  ring->sums[y & (NLM_RING - 1)] = sum;
  return sum + ring->sums[(y - NLM_PATCH) & (NLM_RING - 1)] + ring->rows[(y - 2 * NLM_PATCH) & (NLM_RING - 1)];
}

// One reciprocal serves both halves: W is at most 1e18, so the product is finite.
void nlm_reciprocals(const vf* d, vf* r) {
#if NLM_HALVES == 2
  const vf both = 1.0f / (d[0] * d[1]);
  r[0] = both * d[1];
  r[1] = both * d[0];
#else
  r[0] = 1.0f / d[0];
#endif
}

// Plane of the signal u of half h, channel c; of W + epsilon a, which serves as W in max(W_p, W_q) + epsilon a.
#define NLM_U(h, c) (2 * (h) * NLM_CHANNELS + (c))
#define NLM_W(h, c) ((2 * (h) + 1) * NLM_CHANNELS + (c))

// Of a vector of pixels p.
typedef struct {
  vf u[NLM_HALVES][NLM_CHANNELS], w[NLM_HALVES][NLM_CHANNELS];
} NlmPixels;

// quotients: for the pair (p, q) of each half the sum over the channels of quotients over a; then the same for
// (q, p).
INLINE void nlm_quotients(global const float* q, int pitch, NlmPixels p, float epsilon, vf* quotients) {
  vf n[NLM_HALVES], w[NLM_HALVES];
#pragma unroll
  for (int h = 0; h < NLM_HALVES; ++h) {
    n[h] = -1.5f * NLM_CHANNELS;
    w[h] = -0.5f * NLM_CHANNELS;
  }
#pragma unroll
  for (int c = 0; c < NLM_CHANNELS; ++c) {
    vf d[NLM_HALVES], r[NLM_HALVES], s[NLM_HALVES];
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h) {
      const vf wp = p.w[h][c], wq = fetch(q + NLM_W(h, c) * pitch);
      const vf difference = fetch(q + NLM_U(h, c) * pitch) - p.u[h][c];
      d[h] = (wp - 2 * epsilon) + wq;
      s[h] = fma(difference, difference, wq > wp ? wq : wp);
    }
    nlm_reciprocals(d, r);
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h) {
      n[h] = fma(s[h], r[h], n[h]);
      w[h] = fma(p.w[h][c] - epsilon, r[h], w[h]);
    }
  }
#pragma unroll
  for (int h = 0; h < NLM_HALVES; ++h) {
    quotients[h] = n[h] - w[h];
    quotients[NLM_HALVES + h] = n[h] + w[h];
  }
}

// Down the vector of pixels at column `i` of the maps. sums: NLM_MAPS maps for each offset; then, of a tile
// that is not `whole` (some pixel in reach is not valid), for each offset one that counts pairs of valid
// pixels.
INLINE void nlm_down(global const float* own, NlmTile t, int i, float epsilon, global float* sums,
                         const int whole) {
  NlmRing rings[NLM_GROUP][NLM_MAPS + 1];
  const long map = (long)t.width * t.height, row = (long)NLM_PLANES * t.pitch;
  const int pitch = t.pitch;
  global const float* p = own + nlm_own(t, NLM_PLANES, t.left + i, t.above - NLM_PATCH);
#pragma nounroll
  for (int y = 0; y < t.height + 2 * NLM_PATCH; ++y, p += row) {
    NlmPixels here;
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h)
#pragma unroll
      for (int c = 0; c < NLM_CHANNELS; ++c) {
        here.u[h][c] = fetch(p + NLM_U(h, c) * pitch);
        here.w[h][c] = fetch(p + NLM_W(h, c) * pitch);
      }
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g) {
      global const float* q = p + nlm_step(t, NLM_PLANES, g, 0);
      vf quotient[NLM_MAPS + 1];
      nlm_quotients(q, pitch, here, epsilon, quotient);
      if (!whole) {
        const vi pair = (fetch(p + (NLM_PLANES - 1) * pitch) < (vf)INFINITY) &
                        (fetch(q + (NLM_PLANES - 1) * pitch) < (vf)INFINITY);
#pragma unroll
        for (int m = 0; m < NLM_MAPS; ++m) quotient[m] = pair ? quotient[m] : (vf)0.0f;
        quotient[NLM_MAPS] = pair ? (vf)1.0f : (vf)0.0f;
      }
      global float* to = sums + g * (NLM_MAPS + 1) * map + (long)(y - 2 * NLM_PATCH) * t.width + i;
#pragma unroll
      for (int m = 0; m < NLM_MAPS + 1; ++m) {
        if (m == NLM_MAPS && whole) continue;
        const vf sum = nlm_ring_sum(&rings[g][m], y, quotient[m]);
        if (y >= 2 * NLM_PATCH) put(sum, to + m * map);
      }
    }
  }
}

// What the runs of one filter have alike: how much of an exponent a patch's sum of quotients takes, if it is full;
// the same for their mean; the exponent of the threshold, and epsilon a.
typedef struct {
  float full, mean, threshold, epsilon;
} NlmScales;

// The exponent of the weight of a patch; 0 if it is below the threshold.
vf nlm_exponent(vf sum, vf scale, float threshold) {
  const vf e = fma(sum, -scale, (vf)OF_ONE);
  const vf most = e < (vf)OF_ONE ? e : (vf)OF_ONE;
  return most > (vf)threshold ? most : (vf)0.0f;
}

// Of a pair of offsets (o, -o): the exponents of each half's weights.
typedef struct {
  vf e[2][NLM_HALVES];
} NlmExponents;

// Of offset g and its opposite, for the vector of pixels at (i, row) of the tile, which is at p. Whether any is above
// the threshold.
INLINE int nlm_exponents(global const float* p, NlmTile t, int i, int row, int g, NlmScales k, global const float* sums,
                         NlmExponents* found, const int whole) {
  const long map = (long)t.width * t.height;
  vf most = 0.0f;
#pragma unroll
  for (int back = 0; back < 2; ++back) {
    global const float* here = sums + (long)g * (NLM_MAPS + 1) * map + nlm_site(t, i, row, g, back);
    global const float* valid = p + nlm_step(t, NLM_PLANES, g, back) + (NLM_PLANES - 1) * t.pitch;
    vf scale = k.full;
    if (!whole) {
      const vf count = nlm_across(here + NLM_MAPS * map);
      scale = count == (vf)(float)NLM_FULL ? (vf)k.full : k.mean / count;
    }
#pragma unroll
    for (int h = 0; h < NLM_HALVES; ++h) {
      vf e = nlm_exponent(nlm_across(here + (back * NLM_HALVES + h) * map), scale, k.threshold);
      if (!whole) e = fetch(valid) < (vf)INFINITY ? e : (vf)0.0f;
      most = most > e ? most : e;
      found->e[back][h] = e;
    }
  }
  return any_lane(most > (vf)0.0f);
}

// Of each half the sum of weights, then of each channel that of weighted differences.
typedef struct {
  vf sum[NLM_HALVES][NLM_CHANNELS + 1];
} NlmSums;

// Adds the pixels at q, by the weight that each half has for the other.
INLINE void nlm_add(global const float* p, global const float* q, int pitch, const vf* exponents, float lowered,
                    NlmSums* total) {
#pragma unroll
  for (int h = 0; h < NLM_HALVES; ++h) {
    const int other = NLM_HALVES - 1 - h;
    vf w = number_of(exponents[h]);
#if NLM_SOFT
    w = exponents[h] > (vf)0.0f ? w - lowered : (vf)0.0f;
    w = w > (vf)0.0f ? w : (vf)0.0f;
#endif
    total->sum[other][0] += w;
#pragma unroll
    for (int c = 0; c < NLM_CHANNELS; ++c) {
      const int u = NLM_U(other, c) * pitch;
      total->sum[other][1 + c] = fma(w, fetch(q + u) - fetch(p + u), total->sum[other][1 + c]);
    }
  }
}

// Adds what the offsets of the group give to the vector of pixels at (i, row) of the tile. acc: NlmSums, plane by
// plane. Where no weight of a vector is above the threshold, nothing is added, which is as good as zeros.
INLINE void nlm_gather(global const float* own, NlmTile t, int i, int row, NlmScales k, float lowered,
                       global const float* sums, global float* acc, const int whole) {
  global const float* p = own + nlm_own(t, NLM_PLANES, i, row);
  const long area = (long)t.columns * t.rows;
  NlmSums total;
  int any_weight = 0;
#pragma unroll
  for (int h = 0; h < NLM_HALVES; ++h)
#pragma unroll
    for (int c = 0; c <= NLM_CHANNELS; ++c) total.sum[h][c] = 0.0f;
#pragma nounroll
  for (int g = 0; g < t.offsets; ++g) {
    NlmExponents found;
    if (!nlm_exponents(p, t, i, row, g, k, sums, &found, whole)) continue;
    any_weight = 1;
#pragma unroll
    for (int back = 0; back < 2; ++back)
      nlm_add(p, p + nlm_step(t, NLM_PLANES, g, back), t.pitch, found.e[back], lowered, &total);
  }
  if (!any_weight) return;
  acc += (long)row * t.columns + i;
#pragma unroll
  for (int h = 0; h < NLM_HALVES; ++h)
#pragma unroll
    for (int c = 0; c <= NLM_CHANNELS; ++c, acc += area) put(fetch(acc) + total.sum[h][c], acc);
}

// All offsets of one tile.
INLINE void nlm_offsets(global const float* own, NlmTile t, NlmScales k, float lowered, global float* acc,
                         global float* sums, const int whole) {
  NLM_FOR_EACH_GROUP(t) {
    t = nlm_with_tables(t);
    FOR_EACH_SHARED(i, t.width)
    nlm_down(own, t, i, k.epsilon, sums, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
    for (int row = 0; row < t.rows; ++row) FOR_EACH_SHARED(i, t.columns)
    nlm_gather(own, t, i, row, k, lowered, sums, acc, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
void nlm_store(global const float* valid, global const float* signal, long plane, size_t p,
               global const float* acc, long area, global float* to) {
  const vi is_valid = fetch(valid + p) < (vf)INFINITY;
  for (int h = 0; h < NLM_HALVES; ++h) {
    const vf scale = 1.0f / fetch(acc + h * (NLM_CHANNELS + 1) * area);
    for (int c = 0; c < NLM_CHANNELS; ++c) {
      const vf u = fetch(signal + NLM_U(h, c) * plane + p);
      const vf mean = fma(fetch(acc + (h * (NLM_CHANNELS + 1) + 1 + c) * area), scale, u);
      put(is_valid ? mean : (vf)0.0f, to + (h * NLM_CHANNELS + c) * plane + p);
    }
  }
}

// signals, to: what is read begins at plane `first`, what is written (of each half NLM_CHANNELS planes) at
// `first_to`. scratch: `room` floats for each work-group. k: NlmScales; lowered: by what weights are.
kernel void nlm(global const float* restrict valid, global const float* restrict signals, int first,
                global float* restrict to, int first_to, int stride, long plane, long origin, int x0, int y0,
                int x1, int y1, int columns, int rows, global float* restrict scratch, int room, float4 k,
                float lowered) {
  global const float* signal = signals + (long)first * plane;
  global float* acc = scratch + (long)group_number() * room;
  const NlmScales scales = {k.x, k.y, k.z, k.w};
  for (int n = group_number(); n < tiles_of(x0, y0, x1, y1, columns, rows); n += group_count()) {
    const NlmTile t = nlm_tile(tile_of(n, x0, y0, x1, y1, columns, rows));
    const long area = (long)t.columns * t.rows;
    const int planes = NLM_HALVES * (NLM_CHANNELS + 1);
    global float *own = acc + planes * area, *sums = own + nlm_own_floats(t, NLM_PLANES);
    for (int h = 0; h < planes; ++h)  // the pixel itself has weight 1
      FOR_EACH_SHARED(i, area)
    put((vf)(h % (NLM_CHANNELS + 1) == 0 ? 1.0f : 0.0f), acc + h * area + i);
    for (int c = 0; c < NLM_PLANES; ++c)
      nlm_copy(c < NLM_PLANES - 1 ? signal + c * plane : valid, stride, origin, t, NLM_PLANES,
               own + c * t.pitch);
    barrier(CLK_GLOBAL_MEM_FENCE);
    if (nlm_is_whole(valid, stride, origin, t))
      nlm_offsets(own, t, scales, lowered, acc, sums, 1);
    else
      nlm_offsets(own, t, scales, lowered, acc, sums, 0);
    for (int row = 0; row < t.rows; ++row) FOR_EACH_SHARED(i, t.columns)
    nlm_store(valid, signal, plane, origin + (long)(t.y + row) * stride + t.x + i,
              acc + (long)row * t.columns + i, area, to + (long)first_to * plane);
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
