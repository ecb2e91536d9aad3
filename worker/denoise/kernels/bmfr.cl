// SPDX-License-Identifier: Apache-2.0
// Blockwise Multi-Order Feature Regression (Koskela et al. 2019): what its kernels share, and the synthesis.
//
// The grid of blocks, and every further one half a block away, are made of cells of half a block. So a block's sums
// are those of its four cells, and all grids share them: a cell's sums are taken once (bmfr_cells), four neighbours
// are brought to one basis and solved (bmfr_fit, a window of 2x2 cells a lane), and a pixel is the weighted mean of
// the windows' models (finish).
//   CELL: edge of a cell   GRIDS: how many are taken   COLUMNS: of the fit, 10, or 19 with the noise's
//   window (i, j) is the block whose top left cell is (i, j)
#define PIXELS (CELL * CELL)
#define CHANNELS 16
#define FEATURES 9  // columns of the fit beside the constant: normal, position, its squares

// Light is scaled by a power of two, so that sums of the largest stay finite.
#define DOWN 0x1p-8f
#define UP 0x1p8f

// A window's model: per colour the base, per feature and colour a coefficient; then per axis the origin, the inverse
// extent and the middle (in extents from the origin) of the position, and the normal's origin.
#define COEFFICIENTS 3
#define ORIGIN (COEFFICIENTS + 3 * FEATURES)
#define INVERSE (ORIGIN + 3)
#define MIDDLE (INVERSE + 3)
#define NORMAL (MIDDLE + 3)
#define MODEL (NORMAL + 3)

// Sum, least and largest of a vector's lanes, halves by halves.
#define ADD(a, b) ((a) + (b))
#define LESS(a, b) ((a) < (b) ? (a) : (b))
#define MORE(a, b) ((a) > (b) ? (a) : (b))
#define DEFINE_FOLD(name, of_two)                                       \
  float name##1(float v) { return v; }                                  \
  float name##4(float4 v) {                                             \
    const float2 two = of_two(v.lo, v.hi);                             \
    return of_two(two.x, two.y);                                        \
  }                                                                     \
  float name##8(float8 v) { return name##4(of_two(v.lo, v.hi)); }       \
  float name##16(float16 v) { return name##8(of_two(v.lo, v.hi)); }
DEFINE_FOLD(sum_of, ADD)
DEFINE_FOLD(least_of, LESS)
DEFINE_FOLD(most_of, MORE)
#define sum_of_lanes JOIN(sum_of, VW)
#define least_of_lanes JOIN(least_of, VW)
#define most_of_lanes JOIN(most_of, VW)

// A pixel's features are the film's means, not brought back to unit length: a pixel across an edge is a mixture of
// both sides, in its normal as in its light.
typedef struct {
  vi valid;
  vf normal[3], position[3], light[3];  // 0 where not valid
} Seen;

Seen seen(const vf* in) {
  Seen s;
  s.valid = ordinary(in[IN_DEPTH]) & (in[IN_DEPTH] < (vf)SKY);
#pragma unroll
  for (int c = 0; c < 3; ++c)
    s.valid &= ordinary(in[IN_COLOR + c]) & ordinary(in[IN_EMISSION + c]) & ordinary(in[IN_ALBEDO + c]) &
               ordinary(in[IN_N + c]) & ordinary(in[IN_P + c]);
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf light = (in[IN_COLOR + c] - in[IN_EMISSION + c]) * DOWN / albedo_floored(in[IN_ALBEDO + c]);
    s.light[c] = s.valid ? light : (vf)0.0f;
    s.normal[c] = s.valid ? in[IN_N + c] : (vf)0.0f;
    s.position[c] = s.valid ? in[IN_P + c] : (vf)0.0f;
  }
  return s;
}

// Whether the grid in which a block starts at cells of these parities is one of those taken.
bool grid_is_taken(int odd_column, int odd_row) {
  const int number = odd_column ? (odd_row ? 1 : 2) : (odd_row ? 3 : 0);
  return number < GRIDS;
}

// Adds what the window's model says of the pixels, times `weight`.
void add_model(global const float* model, long plane, const Seen* s, vf weight, vf* light) {
  vf feature[FEATURES];
#pragma unroll
  for (int i = 0; i < 3; ++i) {
    feature[i] = s->normal[i] - model[(NORMAL + i) * plane];
    feature[3 + i] = fma(s->position[i] - model[(ORIGIN + i) * plane], (vf)model[(INVERSE + i) * plane],
                         (vf)-model[(MIDDLE + i) * plane]);
    feature[6 + i] = feature[3 + i] * feature[3 + i];
  }
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    vf y = model[c * plane];
#pragma unroll
    for (int k = 0; k < FEATURES; ++k) y = fma(feature[k], (vf)model[(COEFFICIENTS + 3 * k + c) * plane], y);
    light[c] = fma(weight, y, light[c]);
  }
}

// Light at the pixels [x, x + VW) of the row that is `down` pixels inside the cell (i, j) starting at `left`: the
// windows of the grids taken, weighted by the product of the distances to their nearer borders.
void synthesised(global const float* models, int stride, long plane, int2 odd, int i, int j, int left, int down, int x,
                 const Seen* s, vf* light) {
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = (float)(x - left + k);
  const vf across = (load(lanes) + 0.5f) * (1.0f / CELL);
  const float below = (down + 0.5f) * (1.0f / CELL);
  vf sum = 0.0f;
  light[0] = light[1] = light[2] = 0.0f;
  for (int q = 0; q < 4; ++q) {
    const int wi = i - q % 2, wj = j - q / 2;
    if (!grid_is_taken((wi ^ odd.x) & 1, (wj ^ odd.y) & 1)) continue;
    const vf weight = (q % 2 ? 1.0f - across : across) * (q / 2 ? 1.0f - below : below);
    sum += weight;
    add_model(models + (long)wj * stride + wi, plane, s, weight, light);
  }
  for (int c = 0; c < 3; ++c) {
    const vf mean = light[c] / sum;
    light[c] = mean > (vf)0.0f ? mean * UP : (vf)0.0f;
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour. Cell (0, 0)
// starts at `lattice`.xy and has the parities `odd`.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict models, int stride,
                   long plane, int4 lattice, int2 odd, int x0, int y0, int x1, int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  const int j = (y - lattice.y) / CELL, first = (x0 - lattice.x) / CELL, last = (x1 - 1 - lattice.x) / CELL;
  for (int i = first + (int)get_global_id(0); i <= last; i += (int)get_global_size(0)) {
    const int left = lattice.x + i * CELL, end = min(left + CELL, x1);
    for (int x = max(left, x0); x < end; x += VW) {
      vf in[CHANNELS], light[3];
#pragma unroll
      for (int c = 0; c < CHANNELS; ++c) in[c] = load_first(input + c * area + (size_t)y * w + x, w - x, 0.0f);
      const Seen s = seen(in);
      synthesised(models, stride, plane, odd, i, j, left, (y - lattice.y) % CELL, x, &s, light);
#pragma unroll
      for (int c = 0; c < 3; ++c) {
        const vf color = in[IN_COLOR + c], kept = fabs(color) < (vf)INFINITY ? color : (vf)0.0f;
        const vf lit = light[c] * albedo_floored(in[IN_ALBEDO + c]) + in[IN_EMISSION + c];
        store_first(s.valid ? lit : kept, output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), end - x);
      }
    }
  }
}
