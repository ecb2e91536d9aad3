// SPDX-License-Identifier: Apache-2.0
// Windows whose weights are the same both ways: a pair's is computed once, from its upper pixel (in a row: the left
// one).
//
// Work-groups take tiles, and of a tile a few (PAIR_GROUP) offsets (dx, dy) of one dy at a time, row by row: first the
// weights of the pairs whose upper pixels are in the row, then what the row's pixels take by them, and by those of the
// pairs that they end. So a pixel's sums have one order wherever it lies.
// PAIR_RADIUS: how far offsets go. PAIR_ROWS: of weights that are kept, a power of two above it.

// What weights are computed from, and what is averaged: RGB. All planes lie alike, `plane` floats from one to the next.
typedef struct {
  global const float *guides, *valid, *colors;
  long plane;
  int stride;
} PairPictures;

// Some offsets of a tile: from (first, dy) to (last, dy). Rows of their weights begin `left` of the tile and are
// `width` long, for pixels as far as their opposites reach.
typedef struct {
  global float* weights;
  int dy, first, last, left, width;
} PairOffsets;

PairOffsets pair_offsets(Tile t, int dy, int first, int last, global float* weights) {
  PairOffsets o = {weights, dy, first, last, -max(last, 0), 0};
  o.width = (t.columns - o.left + max(-first, 0) + VW - 1) / VW * VW;
  return o;
}

// Where the weights of offset dx are for the pairs that begin in a row.
global float* pair_row(PairOffsets o, int row, int dx) {
  return o.weights + ((long)(row & (PAIR_ROWS - 1)) * PAIR_GROUP + dx - o.first) * o.width;
}

// Of a filter: the weights of the pairs whose upper pixels are in a row, of which `begin` is the first that has any.
INLINE void pair_weights(PairPictures s, size_t begin, int row, PairOffsets o, float4 k);

// Adds what the pixels of a row take, of which `begin` is the first. acc: sums of weights, and of weighted differences
// of colour.
INLINE void pair_gather(PairPictures s, size_t begin, int row, PairOffsets o, Tile t, global float* acc) {
  const long area = (long)t.columns * t.rows, plane = s.plane;
  FOR_EACH_SHARED(i, t.columns) {
    global float* to = acc + (long)row * t.columns + i;
    global const float* p = s.colors + begin + i;
    const vf red = fetch(p), green = fetch(p + plane), blue = fetch(p + 2 * plane);
    vf sum = fetch(to), reds = fetch(to + area), greens = fetch(to + 2 * area), blues = fetch(to + 3 * area);
#pragma nounroll
    for (int dx = o.first; dx <= o.last; ++dx) {
      const long step = (long)o.dy * s.stride + dx;
#pragma unroll
      for (int back = 0; back < 2; ++back) {
        const vf weight = fetch(pair_row(o, back ? row - o.dy : row, dx) + (back ? i - dx : i) - o.left);
        global const float* q = back ? p - step : p + step;
        sum += weight;
        reds = fma(weight, fetch(q) - red, reds);
        greens = fma(weight, fetch(q + plane) - green, greens);
        blues = fma(weight, fetch(q + 2 * plane) - blue, blues);
      }
    }
    put(sum, to);
    put(reds, to + area);
    put(greens, to + 2 * area);
    put(blues, to + 3 * area);
  }
}

// All pairs of a tile, whose first pixel is `origin`. memory: that of the work-group, of which acc is the beginning.
INLINE void pair_tile(PairPictures s, size_t origin, Tile t, float4 k, global float* acc) {
  const long area = (long)t.columns * t.rows;
  FOR_EACH_SHARED(i, 4 * area) put((vf)(i < area ? 1.0f : 0.0f), acc + i);  // the pixel itself has weight 1
  barrier(CLK_GLOBAL_MEM_FENCE);
  for (int dy = 0; dy <= PAIR_RADIUS; ++dy)
    for (int dx = dy == 0 ? 1 : -PAIR_RADIUS; dx <= PAIR_RADIUS; dx += PAIR_GROUP) {
      const PairOffsets o = pair_offsets(t, dy, dx, min(dx + PAIR_GROUP - 1, PAIR_RADIUS), acc + 4 * area);
      for (int row = -dy; row < t.rows; ++row) {
        const size_t begin = origin + (long)row * s.stride;
        pair_weights(s, begin + o.left, row, o, k);
        barrier(CLK_GLOBAL_MEM_FENCE);
        if (row >= 0) pair_gather(s, begin, row, o, t, acc);
      }
      barrier(CLK_GLOBAL_MEM_FENCE);
    }
}

// The mean of a vector of pixels at p, of which `sums` has what they took: p plus the mean difference, not the mean, so
// that a constant picture comes back bit for bit.
INLINE void pair_mean(PairPictures s, size_t p, global const float* sums, long area, vf* mean) {
  const vf scale = 1.0f / fetch(sums);
  for (int c = 0; c < 3; ++c)
    mean[c] = fma(fetch(sums + (1 + c) * area), scale, fetch(s.colors + c * s.plane + p));
}
