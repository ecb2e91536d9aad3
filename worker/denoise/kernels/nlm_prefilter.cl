// SPDX-License-Identifier: Apache-2.0
// The non-local mean by which the Feature Distance Filter smooths a scalar (Lardinoije, section 4.2): weights
// are the mean over the patches' pairs of pixels of exp(-(u_p - u_q)^2 / (epsilon + V_p + V_q)), so that one
// pixel that agrees is enough for a small weight.
//   valid:  0, or +infinity at pixels that are no neighbours and in the pads
//   signal: a plane of u, one of V + epsilon / 2
// Both directions of a pair have one weight, which is computed once: for each offset of a group a table has the
// weights of all pairs (p, p + o), row by row as they become known, of which a pixel takes its own and that of the
// pair which it ends.

// Planes of a tile's own copy: u, +infinity at pixels that are no neighbours, so that their pairs' exponentials are 0
// without a test (as is that of two of them: infinity less infinity is no number); V; u, 0 there; 0 where all of the
// pixel's patch are neighbours, else +infinity.
#define NLM_PREFILTER_PLANES 4
#define NLM_PREFILTER_V 1
#define NLM_PREFILTER_FINITE 2
#define NLM_PREFILTER_BROKEN 3

// What a group of offsets needs of a tile, in memory that only the work-group uses. Rows are as wide as the tables.
typedef struct {
  global float* rings;    // of each offset NLM_RING rows of exponentials, and as many of sums of two of them
  global float* columns;  // of each offset the row of sums over 2 NLM_PATCH + 1 rows
  global float* weights;  // of each offset a table of all rows
} NlmPrefilter;

NlmPrefilter nlm_prefilter_tables(NlmTile t, global float* memory) {
  NlmPrefilter f;
  f.rings = memory;
  f.columns = f.rings + (long)(NLM_GROUP * 2 * NLM_RING) * t.width + VW;
  f.weights = f.columns + (long)NLM_GROUP * t.width + VW;
  return f;
}

// The tile's own copy. Variances in the unit in which a squared difference over them is what it takes off an exponent.
INLINE void nlm_prefilter_copy(global const float* valid, global const float* signal, int stride, long plane,
                                   long origin, NlmTile t, global float* own, int whole) {
  for (int y = -NLM_REACH; y < t.rows + NLM_REACH; ++y) {
    const long row = origin + (long)(t.y + y) * stride + t.x - NLM_REACH;
    global float* to = own + nlm_own(t, NLM_PREFILTER_PLANES, -NLM_REACH, y);
    FOR_EACH_SHARED(i, t.pitch) {
      const int inside = i < t.columns + 2 * NLM_REACH;
      const vf u = inside ? fetch(signal + row + i) : (vf)0.0f;
      const vf v = inside ? fetch(signal + plane + row + i) : (vf)1.0f;
      put(u + (inside ? fetch(valid + row + i) : (vf)0.0f), to + i);
      put(v * (1 / (LOG2_E * EXPONENT_UNIT)), to + NLM_PREFILTER_V * t.pitch + i);
      put(u, to + NLM_PREFILTER_FINITE * t.pitch + i);
      // Where windows' pixels have all their patch in the copy.
      vf broken = 0.0f;
      if (!whole && inside && y >= -NLM_RADIUS && y < t.rows + NLM_RADIUS)
        for (int k = -NLM_PATCH; k <= NLM_PATCH; ++k)
#pragma unroll
          for (int j = -NLM_PATCH; j <= NLM_PATCH; ++j) broken += fetch(valid + row + i + (long)k * stride + j);
      put(broken, to + NLM_PREFILTER_BROKEN * t.pitch + i);
    }
  }
}

// Takes what a row has at one column into the map's ring. The sum of the last 2 NLM_PATCH + 1 rows.
INLINE vf nlm_prefilter_ring_sum(global float* ring, int width, int y, vf row) {
  const int sums = NLM_RING * width;
#define NLM_ROW(k) (((y - (k)) & (NLM_RING - 1)) * width)
  const vf two = row + fetch(ring + NLM_ROW(1));
  put(row, ring + NLM_ROW(0));
  put(two, ring + sums + NLM_ROW(0));
  vf sum = two;
#pragma unroll
  for (int k = 2; k < 2 * NLM_PATCH; k += 2) sum += fetch(ring + sums + NLM_ROW(k));
  return sum + fetch(ring + NLM_ROW(2 * NLM_PATCH));
}

// Row y of the tables: the pairs of its pixels, and their sums down the columns.
INLINE void nlm_prefilter_pairs(global const float* own, NlmTile t, int y, NlmPrefilter f) {
  global const float* first = own + nlm_own(t, NLM_PREFILTER_PLANES, t.left, y);
  FOR_EACH_SHARED(i, t.width) {
    global const float* p = first + i;
    const vf u = fetch(p), v = fetch(p + NLM_PREFILTER_V * t.pitch);
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g) {
      global const float* q = p + nlm_step(t, NLM_PREFILTER_PLANES, g, 0);
      const vf difference = fetch(q) - u;
      const vf e = OF_ONE - difference * difference / (v + fetch(q + NLM_PREFILTER_V * t.pitch));
      const vf pair = number_of(e > (vf)0.0f ? e : (vf)0.0f);
      put(nlm_prefilter_ring_sum(f.rings + g * 2 * NLM_RING * t.width + i, t.width, y, pair),
               f.columns + g * t.width + i);
    }
  }
}

// By what a sum over the patches about p and q is to be multiplied where some of their pixels are no neighbours; 0 if
// one of themselves is none.
vf nlm_prefilter_share(global const float* p, global const float* q, int pitch) {
  const vi both = (fetch(p) < (vf)INFINITY) & (fetch(q) < (vf)INFINITY);
  if (!any_lane(both)) return 0.0f;
  vf count = 0.0f;
  for (int k = -NLM_PATCH; k <= NLM_PATCH; ++k)
    for (int j = -NLM_PATCH; j <= NLM_PATCH; ++j) {
      const long at = (long)k * NLM_PREFILTER_PLANES * pitch + j;
      const vi pair = (fetch(p + at) < (vf)INFINITY) & (fetch(q + at) < (vf)INFINITY);
      count += pair ? (vf)1.0f : (vf)0.0f;
    }
  const vf share = count == (vf)(float)NLM_FULL ? (vf)1.0f : (float)NLM_FULL / count;
  return both ? share : (vf)0.0f;
}

// The row of weights that the sums over columns complete: that of row y. They count NLM_FULL times. `whole`: no pixel
// in the tile's reach is broken.
INLINE void nlm_prefilter_weights(global const float* own, NlmTile t, int y, NlmPrefilter f, int whole) {
  global const float* first = own + nlm_own(t, NLM_PREFILTER_PLANES, t.left, y);
  for (int g = 0; g < t.offsets; ++g) {
    global float* to = f.weights + ((long)g * t.height + y - t.above) * t.width;
    const long step = nlm_step(t, NLM_PREFILTER_PLANES, g, 0);
    FOR_EACH_SHARED(i, t.width) {
      vf weight = nlm_across(f.columns + g * t.width + i);
      if (!whole) {
        global const float *p = first + i, *q = p + step;
        const vf broken = fetch(p + NLM_PREFILTER_BROKEN * t.pitch) + fetch(q + NLM_PREFILTER_BROKEN * t.pitch);
        if (any_lane(broken > (vf)0.0f)) weight *= nlm_prefilter_share(p, q, t.pitch);
      }
      put(weight, to + i);
    }
  }
}

// Adds what the offsets of the group give to a row of the tile. acc: the sum of weights, then that of weighted
// differences.
INLINE void nlm_prefilter_gather(global const float* own, NlmTile t, int row, NlmPrefilter f, global float* acc) {
  global const float* first = own + nlm_own(t, NLM_PREFILTER_PLANES, 0, row) + NLM_PREFILTER_FINITE * t.pitch;
  const long area = (long)t.columns * t.rows;
  FOR_EACH_SHARED(i, t.columns) {
    global const float* p = first + i;
    global float* to = acc + (long)row * t.columns + i;
    const vf centre = fetch(p);
    vf total = fetch(to), mean = fetch(to + area);
#pragma nounroll
    for (int g = 0; g < t.offsets; ++g)
#pragma unroll
      for (int back = 0; back < 2; ++back) {
        const vf weight = fetch(f.weights + (long)g * t.height * t.width + nlm_site(t, i, row, g, back));
        total += weight;
        mean = fma(weight, fetch(p + nlm_step(t, NLM_PREFILTER_PLANES, g, back)) - centre, mean);
      }
    put(total, to);
    put(mean, to + area);
  }
}

// All offsets of one tile.
INLINE void nlm_prefilter_tile(global const float* own, NlmTile t, global float* acc, global float* memory,
                                   int whole) {
  NLM_FOR_EACH_GROUP(t) {
    t = nlm_with_tables(t);
    const NlmPrefilter f = nlm_prefilter_tables(t, memory);
    for (int y = t.above - NLM_PATCH; y < t.above + NLM_PATCH; ++y) nlm_prefilter_pairs(own, t, y, f);
    for (int row = t.above; row < t.rows; ++row) {
      nlm_prefilter_pairs(own, t, row + NLM_PATCH, f);
      barrier(CLK_GLOBAL_MEM_FENCE);
      nlm_prefilter_weights(own, t, row, f, whole);
      barrier(CLK_GLOBAL_MEM_FENCE);
      if (row >= 0) nlm_prefilter_gather(own, t, row, f, acc);
    }
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
  global float* acc = scratch + (long)group_number() * room;
  for (int n = group_number(); n < tiles_of(x0, y0, x1, y1, columns, rows); n += group_count()) {
    const NlmTile t = nlm_tile(tile_of(n, x0, y0, x1, y1, columns, rows));
    const long area = (long)t.columns * t.rows;
    FOR_EACH_SHARED(i, area) {
      put((vf)(float)NLM_FULL, acc + i);  // the pixel itself has weight 1
      put((vf)0.0f, acc + area + i);
    }
    global float *own = acc + 2 * area, *sums = own + nlm_own_floats(t, NLM_PREFILTER_PLANES);
    const int whole = nlm_is_whole(valid, stride, origin, t);
    nlm_prefilter_copy(valid, signal, stride, plane, origin, t, own, whole);
    barrier(CLK_GLOBAL_MEM_FENCE);
    nlm_prefilter_tile(own, t, acc, sums, whole);
    for (int row = 0; row < t.rows; ++row) FOR_EACH_SHARED(i, t.columns) {
        const size_t p = origin + (long)(t.y + row) * stride + t.x + i;
        global const float* total = acc + (long)row * t.columns + i;
        // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
        const vf result = fetch(signal + p) + fetch(total + area) / fetch(total);
        put(fetch(valid + p) < (vf)INFINITY ? result : (vf)0.0f, to + (long)first_to * plane + p);
      }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}
