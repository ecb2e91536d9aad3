// SPDX-License-Identifier: Apache-2.0
// What the kernels of non-local means share: how they go over a picture.
//
// A work-group takes tiles. Offsets go in pairs (o, -o), a few (NLM_GROUP) neighbours dx of one dy at a time.
// What is computed for pairs of pixels is summed over 2 NLM_PATCH + 1 rows, then over as many columns, which
// completes the patches. A pixel's sums have one order wherever it lies: its bits do not depend on the tile.
#define NLM_TAPS (2 * NLM_PATCH + 1)
#define NLM_RING (NLM_PATCH < 4 ? 8 : 16)  // rows of quotients that are kept; a power of two
#define NLM_FULL (NLM_TAPS * NLM_TAPS)

// The part of the picture that is worked on at a time, for one group of offsets.
typedef struct {
  int x, y, columns, rows;  // its pixels; columns: rounded up to whole vectors
  int pitch;                // of its own copy of the planes
  int dy, dx, offsets;      // the offsets (dx, dy) .. (dx + offsets - 1, dy)
  int left, above;          // pixel of the first sum, seen from (x, y)
  int width, height;        // of a map of sums; width: whole vectors
} NlmTile;

// The tables that the group of offsets needs, for pixels as far as its patches and opposite offsets reach.
NlmTile nlm_with_tables(NlmTile t) {
  const int ahead = max(t.dx + t.offsets - 1, 0), behind = max(-t.dx, 0);
  t.left = -NLM_PATCH - ahead;
  t.above = -t.dy;
  t.height = t.rows + t.dy;
  t.width = (t.columns + 2 * NLM_PATCH + ahead + behind + VW - 1) / VW * VW;
  return t;
}

// A tile's own copy of what its windows and patches reach: row after row, of each row plane after plane, so
// that it lies on few pages of memory. A table may be wider than what is reached, by the rest of a vector.
#define NLM_REACH (NLM_RADIUS + NLM_PATCH)
int nlm_pitch(int columns) { return (columns + 2 * NLM_REACH + NLM_GROUP + 2 * VW - 1) / VW * VW; }
// Where the pixel (x, y) lies, seen from the tile's first, and floats of the whole copy.
long nlm_own(NlmTile t, int planes, int x, int y) {
  return (long)(NLM_REACH + y) * planes * t.pitch + NLM_REACH + x;
}
long nlm_own_floats(NlmTile t, int planes) { return (long)(t.rows + 2 * NLM_REACH) * planes * t.pitch; }

NlmTile nlm_tile(Tile part) {
  NlmTile t;
  t.x = part.x;
  t.y = part.y;
  t.columns = part.columns;
  t.rows = part.rows;
  t.pitch = nlm_pitch(t.columns);
  return t;
}

// The offsets of half the window, in groups; the other half are their opposites.
#define NLM_FOR_EACH_GROUP(t)                \
  for (t.dy = 0; t.dy <= NLM_RADIUS; ++t.dy) \
    for (t.dx = t.dy == 0 ? 1 : -NLM_RADIUS; \
         t.offsets = min(NLM_GROUP, NLM_RADIUS + 1 - t.dx), t.dx <= NLM_RADIUS; t.dx += NLM_GROUP)

// Where a group's sum for the pair with the offset g of it, or its opposite (`back`), lies in its table; and
// the pixel's distance from that at the other end.
long nlm_site(NlmTile t, int i, int row, int g, int back) {
  const int dx = back ? t.dx + g : 0, dy = back ? t.dy : 0;
  return (long)(row - dy - t.above) * t.width + (i - dx - t.left);
}
long nlm_step(NlmTile t, int planes, int g, int back) {
  const long step = (long)t.dy * planes * t.pitch + t.dx + g;
  return back ? -step : step;
}

// The sum of 2 NLM_PATCH + 1 neighbours in a row of a table.
vf nlm_across(global const float* sums) {
  vf sum = fetch(sums - NLM_PATCH);
#pragma unroll
  for (int k = 1 - NLM_PATCH; k <= NLM_PATCH; ++k) sum += fetch(sums + k);
  return sum;
}

// Every pixel that the tile's windows and patches reach is valid.
int nlm_is_whole(global const float* valid, int stride, long origin, NlmTile t) {
  for (int y = t.y - NLM_REACH; y < t.y + t.rows + NLM_REACH; ++y) {
    vi missing = 0;
    for (int x = t.x - NLM_REACH; x < t.x + t.columns + NLM_REACH; x += VW)
      missing |= !(fetch(valid + origin + (long)y * stride + x) < (vf)INFINITY);
    if (any_lane(missing)) return 0;
  }
  return 1;
}
