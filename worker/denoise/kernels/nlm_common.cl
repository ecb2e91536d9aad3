// SPDX-License-Identifier: Apache-2.0
// What the kernels of non-local means share: how they go over a picture.
//
// A work-group takes tiles. Offsets go in pairs (o, -o), a few (NLM_GROUP) neighbours dx of one dy at a time.
// First, down the columns of a tile, what is computed for pairs of pixels is summed over 2 NLM_PATCH + 1
// rows, into tables in the cache; then, row by row, that is summed over as many columns, which completes the
// patches. A pixel's sums have one order wherever it lies: its bits do not depend on the tile.
#define NLM_TAPS (2 * NLM_PATCH + 1)
#define NLM_RING (NLM_PATCH < 4 ? 8 : 16)  // rows of quotients that are kept; a power of two
#define NLM_FULL (NLM_TAPS * NLM_TAPS)
// A vector at any address, in one load: the library's vload is pieces to the compiler, which of overlapping
// vectors shares the pieces and puts them together at several times the cost.
#if VW == 1
#define nlm_load load
#else
typedef vf nlm_unaligned __attribute__((aligned(4)));
#define nlm_load(p) (*(global const nlm_unaligned*)(p))
#endif

// The two cases of `whole` are two programs.
#define NLM_INLINE __attribute__((always_inline))
#if VW == 1
#define NLM_ANY(lanes) (lanes)
#else
#define NLM_ANY(lanes) any(lanes)
#endif

// 1 / d for ordinary d > 0, relative error below 4e-6: the exponent negated by subtracting bits, then e = 1 -
// d y brought from 0.12 to its third power and to the square of that.
vf nlm_reciprocal(vf d) {
  vf y = as_vf(0x7EF311C7 - as_vi(d));
  vf e = fma(-d, y, (vf)1.0f);
  y = fma(y, fma(e, e, e), y);
  e = fma(-d, y, (vf)1.0f);
  return fma(y, e, y);
}

// The part of the picture that is worked on at a time, for one group of offsets.
typedef struct {
  int x, y, columns, rows;  // its pixels; columns: rounded up to whole vectors
  int dy, dx, offsets;      // the offsets (dx, dy) .. (dx + offsets - 1, dy)
  int left, above;          // pixel of the first sum
  int width, height;        // of a map of sums; width: whole vectors
} NlmTile;

// The tables that the group of offsets needs, for pixels as far as its patches and opposite offsets reach.
NlmTile nlm_with_tables(NlmTile t) {
  const int ahead = max(t.dx + t.offsets - 1, 0), behind = max(-t.dx, 0);
  t.left = t.x - NLM_PATCH - ahead;
  t.above = t.y - t.dy;
  t.height = t.rows + t.dy;
  t.width = (t.columns + 2 * NLM_PATCH + ahead + behind + VW - 1) / VW * VW;
  return t;
}

// Tile number n of those of columns x rows (whole vectors) over [x0, x1) x [y0, y1).
NlmTile nlm_tile_of(int n, int x0, int y0, int x1, int y1, int columns, int rows) {
  const int across = (x1 - x0 + columns - 1) / columns;
  NlmTile t;
  t.x = x0 + n % across * columns;
  t.y = y0 + n / across * rows;
  t.columns = (min(columns, x1 - t.x) + VW - 1) / VW * VW;
  t.rows = min(rows, y1 - t.y);
  return t;
}
int nlm_tiles(int x0, int y0, int x1, int y1, int columns, int rows) {
  return (x1 - x0 + columns - 1) / columns * ((y1 - y0 + rows - 1) / rows);
}

// Number of the work-group, and of all.
int nlm_group() { return get_group_id(1) * get_num_groups(0) + get_group_id(0); }
int nlm_groups() { return get_num_groups(0) * get_num_groups(1); }

// The offsets of half the window, in groups; the other half are their opposites.
#define NLM_FOR_EACH_GROUP(t)                \
  for (t.dy = 0; t.dy <= NLM_RADIUS; ++t.dy) \
    for (t.dx = t.dy == 0 ? 1 : -NLM_RADIUS; \
         t.offsets = min(NLM_GROUP, NLM_RADIUS + 1 - t.dx), t.dx <= NLM_RADIUS; t.dx += NLM_GROUP)

// A work-group's items share the columns of a tile.
#define NLM_FOR_EACH_VECTOR(i, width) \
  for (int i = get_local_id(0) * VW; i < (width); i += get_local_size(0) * VW)

// Where a group's sum for the pair with the offset g of it, or its opposite (`back`), lies in its table; and
// the pixel's distance from that at the other end.
long nlm_site(NlmTile t, int i, int row, int g, int back) {
  const int dx = back ? t.dx + g : 0, dy = back ? t.dy : 0;
  return (long)(t.y + row - dy - t.above) * t.width + (t.x + i - dx - t.left);
}
long nlm_step(NlmTile t, int stride, int g, int back) {
  const long step = (long)t.dy * stride + t.dx + g;
  return back ? -step : step;
}

// The last 2 NLM_PATCH + 1 of what a ring was given, number y the last of them, in the order in which it was.
vf nlm_ring_sum(const vf* ring, int y) {
  vf sum = ring[(y - 2 * NLM_PATCH) & (NLM_RING - 1)];
#pragma unroll
  for (int k = 2 * NLM_PATCH - 1; k >= 0; --k) sum += ring[(y - k) & (NLM_RING - 1)];
  return sum;
}

// The sum of 2 NLM_PATCH + 1 neighbours in a row of a table.
vf nlm_across(global const float* sums) {
  vf sum = nlm_load(sums - NLM_PATCH);
#pragma unroll
  for (int k = 1 - NLM_PATCH; k <= NLM_PATCH; ++k) sum += nlm_load(sums + k);
  return sum;
}

// Every pixel that the tile's windows and patches reach is valid.
int nlm_is_whole(global const float* valid, int stride, long origin, NlmTile t) {
  const int reach = NLM_RADIUS + NLM_PATCH;
  for (int y = t.y - reach; y < t.y + t.rows + reach; ++y) {
    vi missing = 0;
    for (int x = t.x - reach; x < t.x + t.columns + reach; x += VW)
      missing |= !(nlm_load(valid + origin + (long)y * stride + x) < (vf)INFINITY);
    if (NLM_ANY(missing)) return 0;
  }
  return 1;
}
