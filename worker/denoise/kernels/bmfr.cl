// SPDX-License-Identifier: Apache-2.0
// Blockwise Multi-Order Feature Regression (Koskela et al. 2019): what its kernels share, and the synthesis.
//
// The grid of blocks, and every further one half a block away, are made of cells of half a block. So a block's sums
// are those of its four cells, and all grids share them: a cell's sums are taken once (bmfr_cells), four neighbours
// are brought to one basis and solved (bmfr_fit, a window of 2x2 cells a lane), and a pixel is the weighted mean of
// the windows' models (finish).
//   CELL: edge of a cell   GRIDS: how many are taken   TEMPORAL: light and what is valid come from bmfr_accumulate
//   NORMALS, POSITIONS: 0 not taken, 1 as they are, 2 and squared   GRADIENTS, MATERIAL: whether taken
//   COLUMNS: of the fit, 1 + FEATURES, or with the noise's 1 + 2 * FEATURES
//   window (i, j) is the block whose top left cell is (i, j)
#define PIXELS (CELL * CELL)
#define CHANNELS 16

// Columns of the fit beside the constant: each kind's first, and how many there are.
#define OF_NORMALS 0
#define OF_POSITIONS (3 * NORMALS)
#define OF_GRADIENTS (OF_POSITIONS + 3 * POSITIONS)
#define OF_MATERIAL (OF_GRADIENTS + 2 * GRADIENTS)
#define FEATURES (OF_MATERIAL + MATERIAL)
// What is scaled to -1 .. 1 within the block: the position's axes, the material.
#define POSITION_AXES (POSITIONS > 0 ? 3 : 0)
#define AXES (POSITION_AXES + MATERIAL)
#define OR_ONE(n) ((n) > 0 ? (n) : 1)  // of arrays

int feature_of_axis(int axis) { return axis < POSITION_AXES ? OF_POSITIONS + axis : OF_MATERIAL; }
bool is_squared(int axis) { return POSITIONS == 2 ? axis < POSITION_AXES : false; }

// Light is scaled by a power of two, so that sums of the largest stay finite.
#define DOWN 0x1p-8f
#define UP 0x1p8f

// A window's model: per colour the base, per feature and colour a coefficient; then per axis the origin, the inverse
// extent and the middle (in extents from the origin), and the normal's origin.
#define COEFFICIENTS 3
#define ORIGIN (COEFFICIENTS + 3 * FEATURES)
#define INVERSE (ORIGIN + AXES)
#define MIDDLE (INVERSE + AXES)
#define NORMAL (MIDDLE + AXES)

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
  vf normal[3], axis[4], light[3];  // 0 where not valid; axis: position, material
} Pixel;

// in: channels as in the input, of which the first CHANNELS and the material are looked at.
INLINE vi valid_pixel(const vf* in) {
  vi valid = ordinary(in[IN_DEPTH]) & (in[IN_DEPTH] < (vf)SKY);
#pragma unroll
  for (int c = 0; c < 3; ++c)
    valid &= ordinary(in[IN_COLOR + c]) & ordinary(in[IN_EMISSION + c]) & ordinary(in[IN_ALBEDO + c]) &
             ordinary(in[IN_N + c]) & ordinary(in[IN_P + c]);
  return valid;
}

INLINE void set_features(Pixel* s, const vf* in, vf material) {
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    s->normal[c] = s->valid ? in[IN_N + c] : (vf)0.0f;
    s->axis[c] = s->valid ? in[IN_P + c] : (vf)0.0f;
  }
#if MATERIAL
  s->axis[POSITION_AXES] = s->valid ? material : (vf)0.0f;
#endif
}

INLINE vf light_of(const vf* in, int c) {
  return (in[IN_COLOR + c] - in[IN_EMISSION + c]) * DOWN / albedo_floored(in[IN_ALBEDO + c]);
}

INLINE Pixel pixel_of(const vf* in, vf material) {
  Pixel s;
  s.valid = valid_pixel(in);
  set_features(&s, in, material);
#pragma unroll
  for (int c = 0; c < 3; ++c) s.light[c] = s.valid ? light_of(in, c) : (vf)0.0f;
  return s;
}

// Whether the grid in which a block starts at cells of these parities is one of those taken.
bool grid_is_taken(int odd_column, int odd_row) {
  const int number = odd_column ? (odd_row ? 1 : 2) : (odd_row ? 3 : 0);
  return number < GRIDS;
}

// Where in a block of 2 * CELL pixels a pixel is, from -1 at the first to 1 at the last.
#define GRADIENT(i) fma((i), (vf)(2.0f / (2 * CELL - 1)), (vf)-1.0f)

// Adds what the window's model says of the pixels, times `weight`. (i, j): where in the window they are.
void add_model(global const float* model, long plane, const Pixel* s, vf i, vf j, vf weight, vf* light) {
  vf feature[OR_ONE(FEATURES)];
#pragma unroll
  for (int c = 0; c < (NORMALS > 0 ? 3 : 0); ++c) {
    feature[OF_NORMALS + c] = s->normal[c] - model[(NORMAL + c) * plane];
    if (NORMALS == 2) feature[OF_NORMALS + 3 + c] = feature[OF_NORMALS + c] * feature[OF_NORMALS + c];
  }
#pragma unroll
  for (int c = 0; c < AXES; ++c) {
    const vf u = fma(s->axis[c] - model[(ORIGIN + c) * plane], (vf)model[(INVERSE + c) * plane],
                     (vf)-model[(MIDDLE + c) * plane]);
    feature[feature_of_axis(c)] = u;
    if (is_squared(c)) feature[feature_of_axis(c) + 3] = u * u;
  }
#if GRADIENTS
  feature[OF_GRADIENTS] = GRADIENT(i);
  feature[OF_GRADIENTS + 1] = GRADIENT(j);
#endif
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
                 const Pixel* s, vf* light) {
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = (float)(x - left + k);
  const vf inside = load(lanes), across = (inside + 0.5f) * (1.0f / CELL);
  const float below = (down + 0.5f) * (1.0f / CELL);
  vf sum = 0.0f;
  light[0] = light[1] = light[2] = 0.0f;
  for (int q = 0; q < 4; ++q) {
    const int wi = i - q % 2, wj = j - q / 2;
    if (!grid_is_taken((wi ^ odd.x) & 1, (wj ^ odd.y) & 1)) continue;
    const vf weight = (q % 2 ? 1.0f - across : across) * (q / 2 ? 1.0f - below : below);
    sum += weight;
    add_model(models + (long)wj * stride + wi, plane, s, inside + (float)(q % 2 * CELL), (float)(q / 2 * CELL + down),
              weight, light);
  }
  for (int c = 0; c < 3; ++c) {
    const vf mean = light[c] / sum;
    light[c] = mean > (vf)0.0f ? mean * UP : (vf)0.0f;
  }
}
