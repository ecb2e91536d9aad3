// SPDX-License-Identifier: Apache-2.0
// The sums of products over each cell that the fits are made of. The order in which they are added depends on where
// in the cell a pixel lies and on nothing else.
//
// Within a cell the columns are: 0 is 1; then the features in their order, the normal from the cell's mean one (as it
// is, where squared), axes from -1 to 1 in the cell, the place in the cell likewise; with the stochastic regularisation
// as much noise from -1 to 1. Then the light, from the cell's mean one. All are 0 at invalid pixels. What a cell holds:
// the sums, as often as it has roles, then for each axis its middle, lowest and highest from there, then mean normal,
// mean light.
#define WIDTH (COLUMNS + 3)
#define SUMS (COLUMNS * (COLUMNS + 1) / 2 + 3 * COLUMNS)
#if COLUMNS > 1 + FEATURES
#define ROLES 4  // the noise depends on where in the block a pixel lies, hence on which of its quarters the cell is
#else
#define ROLES 1
#endif
#define MIDDLES (ROLES * SUMS)
#define LOWEST (MIDDLES + AXES)
#define HIGHEST (LOWEST + AXES)
#define MEAN_NORMAL (HIGHEST + AXES)
#define MEAN_LIGHT (MEAN_NORMAL + 3)

typedef float Column[PIXELS];
#define FOR_EACH_PIXEL(v) for (int v = 0; v < PIXELS; v += VW)

// Beyond the border of a picture of `size` pixels lies its mirror image, and beyond that its mirror image.
int mirrored(int i, int size) {
  const int period = 2 * size, k = (i % period + period) % period;
  return k < size ? k : period - 1 - k;
}

// VW pixels of a cell, from number v: rows of it, one after another.
vf of_rows(global const float* cell, int w, int v) {
#if CELL >= VW
  return load(cell + (size_t)(v / CELL) * w + v % CELL);
#else
  float lanes[VW];
#pragma unroll
  for (int row = 0; row < VW / CELL; ++row)
#pragma unroll
    for (int k = 0; k < CELL; ++k) lanes[row * CELL + k] = cell[(size_t)(v / CELL + row) * w + k];
  return load(lanes);
#endif
}

vf scattered(global const float* plane, const int* at) {
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = plane[at[k]];
  return load(lanes);
}

void keep(const Pixel* s, Column* column, int v) {
  store(s->valid ? (vf)1.0f : (vf)0.0f, column[0] + v);
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    if (NORMALS > 0) store(s->normal[c], column[1 + OF_NORMALS + c] + v);
    store(s->light[c], column[COLUMNS + c] + v);
  }
#pragma unroll
  for (int c = 0; c < AXES; ++c) store(s->axis[c], column[1 + feature_of_axis(c)] + v);
}

// The cell at (x0, y0) as it is, in the columns of normals, axes and light.
void read(global const float* input, global const float* accumulated, int w, size_t area, int4 frame, int x0, int y0,
          Column* column) {
  const bool inside = x0 >= frame.x && y0 >= frame.y && x0 + CELL <= frame.z && y0 + CELL <= frame.w;
  FOR_EACH_PIXEL(v) {
    int at[VW];
    if (!inside)
      for (int k = 0; k < VW; ++k)
        at[k] = (mirrored(y0 + (v + k) / CELL - frame.y, frame.w - frame.y) + frame.y) * w +
                mirrored(x0 + (v + k) % CELL - frame.x, frame.z - frame.x) + frame.x;
#define SEEN(plane) (inside ? of_rows((plane) + (long)y0 * w + x0, w, v) : scattered(plane, at))
    vf in[CHANNELS], material = 0.0f;
#if MATERIAL
    material = SEEN(input + IN_MATERIALID * area);
#endif
#if TEMPORAL
    Pixel s;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      in[IN_N + c] = SEEN(input + (IN_N + c) * area);
      in[IN_P + c] = SEEN(input + (IN_P + c) * area);
      s.light[c] = SEEN(accumulated + c * area);
    }
    s.valid = SEEN(accumulated + COUNT * area) > (vf)0.0f;
    set_features(&s, in, material);
#else
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) in[c] = SEEN(input + c * area);
    const Pixel s = pixel_of(in, material);
#endif
    keep(&s, column, v);
  }
}

float sum_of_column(const float* column) {
  vf sum = 0.0f;
  FOR_EACH_PIXEL(v) sum += load(column + v);
  return sum_of_lanes(sum);
}

vf luminance_of(const Column* light, int v) {
  return luminance(load(light[0] + v), load(light[1] + v), load(light[2] + v));
}

// Luminance is clamped to the cell's mean plus `deviations` standard deviations, twice: the first time, what stands
// out has widened the deviation itself. No share of more than 1 / (1 + deviations^2) is ever clamped (Cantelli).
void clamp_light(const float* valid, float count, float deviations, Column* light) {
  for (int round = 0; round < 2; ++round) {
    vf sum = 0.0f, largest = 0.0f, squares = 0.0f;
    FOR_EACH_PIXEL(v) {
      const vf l = luminance_of(light, v);
      sum += l;
      largest = MORE(fabs(l), largest);
    }
    const float mean = sum_of_lanes(sum) / count, most = most_of_lanes(largest);
    if (!(most > 0.0f)) return;
    FOR_EACH_PIXEL(v) {
      const vf d = (luminance_of(light, v) - mean) * (1.0f / most) * load(valid + v);
      squares = fma(d, d, squares);
    }
    const float limit = fmax(fma(deviations * most, sqrt(sum_of_lanes(squares) / count), mean), 0.0f);
    if (most <= limit) return;
    FOR_EACH_PIXEL(v) {
      const vf l = luminance_of(light, v);
      const vf scale = l > (vf)limit ? limit / l : (vf)1.0f;
      for (int c = 0; c < 3; ++c) store(load(light[c] + v) * scale, light[c] + v);
    }
  }
}

// Makes the axis' column, which holds its values, and that of its squares if there is one.
void scale_axis(Column* column, int axis, global float* out, long plane) {
  float *values = column[1 + feature_of_axis(axis)], *squares = column[is_squared(axis) ? 4 + feature_of_axis(axis) : 0];
  vf low = INFINITY, high = -INFINITY;
  FOR_EACH_PIXEL(v) {
    const vi valid = load(column[0] + v) > (vf)0.0f;
    const vf p = load(values + v);
    low = valid && p < low ? p : low;
    high = valid && p > high ? p : high;
  }
  const float lowest = least_of_lanes(low), highest = most_of_lanes(high);
  const float middle = 0.5f * lowest + 0.5f * highest;
  const float extent = fmax(highest - middle, middle - lowest), inverse = extent > 0.0f ? 1.0f / extent : 0.0f;
  FOR_EACH_PIXEL(v) {
    const vf u = (load(values + v) - middle) * inverse * load(column[0] + v);
    store(u, values + v);
    if (is_squared(axis)) store(u * u, squares + v);
  }
  out[(MIDDLES + axis) * plane] = middle;
  out[(LOWEST + axis) * plane] = lowest - middle;
  out[(HIGHEST + axis) * plane] = highest - middle;
}

// Makes a column of differences from its mean. Returns the mean.
float centre(const float* valid, float count, float* column) {
  const float mean = sum_of_column(column) / count;
  FOR_EACH_PIXEL(v) store((load(column + v) - mean) * load(valid + v), column + v);
  return mean;
}

#if NORMALS
// Makes the normal's column, and that of its squares. Squares are those of the normal as it is.
void make_normals(Column* column, float count, int c, global float* out, long plane) {
  float* values = column[1 + OF_NORMALS + c];
#if NORMALS == 2
  FOR_EACH_PIXEL(v) store(load(values + v) * load(values + v), column[4 + OF_NORMALS + c] + v);
#else
  out[(MEAN_NORMAL + c) * plane] = centre(column[0], count, values);
#endif
}
#endif

#if GRADIENTS
void make_gradients(Column* column) {
  for (int v = 0; v < PIXELS; ++v) {
    column[1 + OF_GRADIENTS][v] = fma((float)(v % CELL), 2.0f / (CELL - 1), -1.0f) * column[0][v];
    column[2 + OF_GRADIENTS][v] = fma((float)(v / CELL), 2.0f / (CELL - 1), -1.0f) * column[0][v];
  }
}
#endif

#if ROLES > 1
// Jarzynski and Olano 2020, "Hash Functions for GPU Rendering", JCGT 9(3): PCG with 32 bits.
uint hash(uint v) {
  const uint state = v * 747796405u + 2891336453u, word = ((state >> ((state >> 28) + 4)) ^ state) * 277803737u;
  return (word >> 22) ^ word;
}

// Of the quarter `role` of a block: keyed by feature, place in the block and frame, so all blocks have the same.
void make_noise(int role, int frame, Column* column) {
  for (int k = 0; k < FEATURES; ++k)
    for (int v = 0; v < PIXELS; ++v) {
      const uint x = role % 2 * CELL + v % CELL, y = role / 2 * CELL + v / CELL;
      const uint bits = hash(((frame * 16 + 1 + k) * 2 * CELL + y) * 2 * CELL + x) >> 8;
      column[1 + FEATURES + k][v] = fma((float)bits, 0x1p-23f, -1.0f) * column[0][v];
    }
}
#endif

// The products of each column with itself and all behind it, four at a time.
void sum_up(const Column* column, global float* out, long plane) {
  for (int a = 0; a < COLUMNS; ++a)
    for (int b = a; b < WIDTH; b += 4) {
      const float *c0 = column[b], *c1 = column[min(b + 1, WIDTH - 1)], *c2 = column[min(b + 2, WIDTH - 1)],
                  *c3 = column[min(b + 3, WIDTH - 1)];
      vf s0 = 0.0f, s1 = 0.0f, s2 = 0.0f, s3 = 0.0f;
      FOR_EACH_PIXEL(v) {
        const vf f = load(column[a] + v);
        s0 = fma(f, load(c0 + v), s0);
        s1 = fma(f, load(c1 + v), s1);
        s2 = fma(f, load(c2 + v), s2);
        s3 = fma(f, load(c3 + v), s3);
      }
      const float sums[4] = {sum_of_lanes(s0), sum_of_lanes(s1), sum_of_lanes(s2), sum_of_lanes(s3)};
      for (int k = 0; k < 4 && b + k < WIDTH; ++k, out += plane) *out = sums[k];
    }
}

// lattice: where cell (0, 0) starts in the outer region, and how many cells there are across and down.
// accumulated: planes of bmfr_accumulate over the outer region.
kernel void bmfr_cells(global const float* restrict input, global const float* restrict accumulated, int w, int h,
                       int4 frame, int4 lattice, float deviations, int frame_number, global float* restrict cells,
                       int stride, long plane) {
  const int j = get_global_id(1);
  if (j >= lattice.w) return;
  for (int i = get_global_id(0); i < lattice.z; i += (int)get_global_size(0)) {
    Column column[WIDTH];
    global float* out = cells + (long)j * stride + i;
    read(input, accumulated, w, (size_t)w * h, frame, lattice.x + i * CELL, lattice.y + j * CELL, column);
    const float count = sum_of_column(column[0]);
    if (count == 0.0f) {
      for (int k = 0; k < MEAN_LIGHT + 3; ++k) out[k * plane] = 0.0f;
      continue;
    }
    clamp_light(column[0], count, deviations, column + COLUMNS);
    for (int c = 0; c < 3; ++c) {
      out[(MEAN_LIGHT + c) * plane] = centre(column[0], count, column[COLUMNS + c]);
#if NORMALS
      make_normals(column, count, c, out, plane);
#endif
    }
    for (int c = 0; c < AXES; ++c) scale_axis(column, c, out, plane);
#if GRADIENTS
    make_gradients(column);
#endif
#if ROLES > 1
    for (int role = 0; role < ROLES; ++role) {
      make_noise(role, frame_number, column);
      sum_up(column, out + role * SUMS * plane, plane);
    }
#else
    sum_up(column, out, plane);
#endif
  }
}
