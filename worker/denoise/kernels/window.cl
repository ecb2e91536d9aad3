// SPDX-License-Identifier: Apache-2.0
// Windows of which every tap has a weight of its own: what they read, laid out in strips.
//
// A strip is STRIP columns of the inner region with PAD more on either side, and all rows that its windows reach;
// row after row, and of each row plane after plane, PITCH floats apart. So the addresses of all planes and taps of
// a row are one pointer and constants, and a strip's windows stay in the cache while its rows are walked.
// RADIUS, STEP: how far a window reaches, and how far its taps lie apart. PLANES: in a strip.

// A plane that is finite for it is also summed up, at pixels that may be none's neighbour: its square is infinite,
// so that their weight is exactly 0, and 0 times it is 0.
#define FAR 1e38f

// The number whose exponent is e <= OF_ONE. Relative error below 9e-5 (and 4e-6 for each rounding of e); exactly 1 at
// OF_ONE; exactly 0 at -infinity, no more than 2^-126 below EXPONENT_UNIT. The mantissa m in [1, 2) becomes 2^(m - 1)
// by a minimax polynomial of degree 3 that is 1 at 1 and stays in [1, 2) after rounding. A third of the cost of
// exp2_of_negative, for windows with hundreds of weights a pixel.
vf weight_of(vf e) {
  const vi bits = to_int(e > (vf)0.0f ? e : (vf)0.0f);
  const vf m = as_vf((bits & 0x007fffff) | 0x3f800000);
  vf p = 0.0770670399f;
  p = fma(p, m, (vf)-0.00355613488f);
  p = fma(p, m, (vf)0.471027941f);
  p = fma(p, m, (vf)0.455461174f);
  const int exponent = 0xff800000;
  return as_vf((as_vi(p) & ~exponent) | (bits & exponent));
}

// Arguments of every kernel: the input over w x h pixels, the strips, the pixels [x0, x1) x [y0, y1) of the outer
// region that are filtered.
#define WINDOW_INPUT global const float *restrict input, int w, int h
#define WINDOW_REGION int x0, int y0, int x1, int y1

// Where a work-item's row lies: kernels run over strips * rows rows, strip by strip where windows are walked, and in
// the picture's order where it is only read.
typedef struct {
  int strip, row;
} StripRow;

StripRow strip_row(int index, int rows) {
  StripRow s = {index / rows, index % rows};
  return s;
}

StripRow picture_row(int index, int columns) {
  const int strips = (columns + STRIP - 1) / STRIP;
  StripRow s = {index % strips, index / strips};
  return s;
}

// Vectors that a work-item filters side by side, one row of their windows after the other, so that all of them take
// their taps of a row while it is in the nearest cache. A vector of one pixel, as on GPUs, is alone.
#define SIDE (VW == 1 ? 1 : STRIP / VW)

// First float of plane 0 of row `row` (0: the first that is read) of a strip of `rows` rows.
size_t strip_offset(StripRow s, int rows) { return ((size_t)s.strip * rows + s.row) * (PLANES * PITCH); }

// What a work-item filters: one row of a strip.
typedef struct {
  int y, first, columns;    // its row of the outer region; its first column, seen from x0
  size_t strip, out, area;  // its first pixel in plane 0 of the strips, in the output; a plane of the output
} WindowRow;

WindowRow window_row(WINDOW_REGION) {
  const int rows = y1 - y0;
  StripRow s = strip_row(get_global_id(1), rows);
  WindowRow r;
  r.y = y0 + s.row;
  r.first = s.strip * STRIP;
  r.columns = min(STRIP, x1 - x0 - r.first);
  r.out = (size_t)s.row * (x1 - x0) + r.first;
  r.area = (size_t)(x1 - x0) * rows;
  s.row += RADIUS;
  r.strip = strip_offset(s, rows + 2 * RADIUS) + PAD;
  return r;
}

// VW floats of a row of w, of which those outside it are `rest`.
vf load_within(global const float* row, int x, int w, float rest) {
  if (x >= 0 && x + VW <= w) return fetch(row + x);
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = x + k >= 0 && x + k < w ? row[x + k] : rest;
  return load(lanes);
}

// All pixels of a vector as none's neighbours: plane 0 lies `far`.
void store_outside(global float* to, float far) {
  for (int c = 0; c < PLANES; ++c) put((vf)(c == 0 ? far : 0.0f), to + c * PITCH);
}
