// SPDX-License-Identifier: Apache-2.0
// The fit of each window of 2x2 cells, a window a lane: its cells' sums brought to the window's own basis and added,
// then ridge regression by a root-free Cholesky factorisation.
typedef vf Matrix[COLUMNS][WIDTH];  // sums of products of columns; the last three columns are the light

void read_sums(global const float* cell, long plane, Matrix m) {
  for (int a = 0; a < COLUMNS; ++a)
    for (int b = a; b < WIDTH; ++b, cell += plane) {
      m[a][b] = load(cell);
      if (b < COLUMNS) m[b][a] = m[a][b];
    }
}

// The sums after column a has become f times itself.
void scale_column(Matrix m, int a, vf f) {
  for (int k = 0; k < WIDTH; ++k) m[a][k] *= f;
  for (int k = 0; k < COLUMNS; ++k) m[k][a] *= f;
}

// The sums after f times column b has been added to column a.
void add_column(Matrix m, int a, int b, vf f) {
  for (int k = 0; k < WIDTH; ++k) m[a][k] = fma(f, m[b][k], m[a][k]);
  for (int k = 0; k < COLUMNS; ++k) m[k][a] = fma(f, m[k][b], m[k][a]);
}

// From what a window's columns are measured: the origins are those of its first cell with any valid pixel. Axes are
// counted from there before they are scaled, for differences of neighbours are exact.
typedef struct {
  vf origin[OR_ONE(AXES)], normal[3], light[3];
  vf middle[OR_ONE(AXES)], inverse[OR_ONE(AXES)];  // counted from the origin; 1 over half of the range, 0 if none
} Basis;

void set_extent(Basis* b, int axis, global const float* const* cell, long plane) {
  vf low = INFINITY, high = -INFINITY;
  for (int q = 0; q < 4; ++q) {
    const vi valid = load(cell[q]) > (vf)0.0f;
    const vf at = load(cell[q] + (MIDDLES + axis) * plane) - b->origin[axis];
    const vf l = at + load(cell[q] + (LOWEST + axis) * plane), u = at + load(cell[q] + (HIGHEST + axis) * plane);
    low = valid && l < low ? l : low;
    high = valid && u > high ? u : high;
  }
  const vf extent = 0.5f * high - 0.5f * low;
  b->middle[axis] = 0.5f * low + 0.5f * high;
  b->inverse[axis] = extent > (vf)0.0f ? 1.0f / extent : (vf)0.0f;
}

Basis basis_of(global const float* const* cell, long plane) {
  Basis b;
  vi any = 0;
  for (int q = 0; q < 4; ++q) {
    const vi first = q == 0 ? (vi)-1 : !any & (load(cell[q]) > (vf)0.0f);
    any |= load(cell[q]) > (vf)0.0f;
    for (int c = 0; c < AXES; ++c)
      b.origin[c] = first ? load(cell[q] + (MIDDLES + c) * plane) : b.origin[c];
    for (int c = 0; c < 3; ++c) {
      const vf normal = NORMALS == 1 ? load(cell[q] + (MEAN_NORMAL + c) * plane) : (vf)0.0f;
      b.normal[c] = first ? normal : b.normal[c];
      b.light[c] = first ? load(cell[q] + (MEAN_LIGHT + c) * plane) : b.light[c];
    }
  }
  for (int c = 0; c < AXES; ++c) set_extent(&b, c, cell, plane);
  return b;
}

// The sums of a cell, which is the q-th of the window, in the window's basis.
void change_basis(global const float* cell, int q, long plane, const Basis* b, float epsilon, Matrix m) {
  for (int c = 0; c < AXES; ++c) {
    const vf low = load(cell + (LOWEST + c) * plane), high = load(cell + (HIGHEST + c) * plane);
    const vf extent = MORE(-low, high), at = load(cell + (MIDDLES + c) * plane) - b->origin[c];
    const vf scale = extent * b->inverse[c], shift = (at - b->middle[c]) * b->inverse[c];
    const int a = 1 + feature_of_axis(c);
    scale_column(m, a, scale);
    if (is_squared(c)) {
      scale_column(m, a + 3, scale * scale);
      add_column(m, a + 3, a, 2 * shift);
      add_column(m, a + 3, 0, shift * shift);
    }
    add_column(m, a, 0, shift);
  }
  for (int c = 0; c < 3; ++c) {
    if (NORMALS == 1) add_column(m, 1 + OF_NORMALS + c, 0, load(cell + (MEAN_NORMAL + c) * plane) - b->normal[c]);
    const vf lighter = load(cell + (MEAN_LIGHT + c) * plane) - b->light[c];
    for (int k = 0; k < COLUMNS; ++k) m[k][COLUMNS + c] = fma(lighter, m[k][0], m[k][COLUMNS + c]);
  }
#if GRADIENTS
  for (int c = 0; c < 2; ++c) {
    const bool behind = c == 0 ? q % 2 : q / 2;
    scale_column(m, 1 + OF_GRADIENTS + c, (CELL - 1.0f) / (2 * CELL - 1));
    add_column(m, 1 + OF_GRADIENTS + c, 0, (behind ? CELL : -CELL) / (2 * CELL - 1.0f));
  }
#endif
#if ROLES > 1
  for (int k = 1; k <= FEATURES; ++k) add_column(m, k, FEATURES + k, epsilon);
#endif
}

// total: sums over the window. Leaves the coefficients where the features' products with the light were, and the
// means where the products with column 0 were. Ridge and least pivot are times the number of pixels. With noise in the
// place of a ridge, windows of fewer than twice as many pixels as columns have no coefficients.
void solve(Matrix m, float ridge, float least) {
  const vf inverse_count = m[0][0] > (vf)0.0f ? 1.0f / m[0][0] : (vf)0.0f;
  for (int a = 1; a <= FEATURES; ++a)
    for (int b = a; b < WIDTH; ++b)
      if (b <= FEATURES || b >= COLUMNS) m[a][b] = fma(-m[0][a] * inverse_count, m[0][b], m[a][b]);
  for (int a = 1; a <= FEATURES; ++a) m[a][a] += ridge * m[0][0];
  const vf floor = MORE(least * m[0][0], (vf)1e-20f);
  for (int a = 1; a <= FEATURES; ++a) {
#if ROLES > 1
    const vf inverse = m[0][0] >= (vf)(2.0f * (FEATURES + 1)) ? 1.0f / MORE(m[a][a], floor) : (vf)0.0f;
#else
    const vf inverse = 1.0f / MORE(m[a][a], floor);
#endif
    for (int b = a + 1; b <= FEATURES; ++b) {
      const vf f = m[a][b] * inverse;
      for (int k = b; k <= FEATURES; ++k) m[b][k] = fma(-f, m[a][k], m[b][k]);
      for (int k = COLUMNS; k < WIDTH; ++k) m[b][k] = fma(-f, m[a][k], m[b][k]);
    }
    for (int k = a + 1; k <= FEATURES; ++k) m[a][k] *= inverse;
    for (int k = COLUMNS; k < WIDTH; ++k) m[a][k] *= inverse;
  }
  for (int a = FEATURES; a >= 1; --a)
    for (int b = a + 1; b <= FEATURES; ++b)
      for (int k = COLUMNS; k < WIDTH; ++k) m[a][k] = fma(-m[a][b], m[b][k], m[a][k]);
  for (int k = 1; k < WIDTH; ++k) m[0][k] *= inverse_count;
}

// Of the first n windows.
void store_model(Matrix m, const Basis* b, global float* model, long plane, int n) {
  for (int c = 0; c < 3; ++c) {
    vf base = m[0][COLUMNS + c];
    for (int k = 0; k < FEATURES; ++k) {
      base = fma(-m[1 + k][COLUMNS + c], m[0][1 + k], base);
      store_first(m[1 + k][COLUMNS + c], model + (COEFFICIENTS + 3 * k + c) * plane, n);
    }
    store_first(b->light[c] + base, model + c * plane, n);
    store_first(b->normal[c], model + (NORMAL + c) * plane, n);
  }
  for (int c = 0; c < AXES; ++c) {
    store_first(b->origin[c], model + (ORIGIN + c) * plane, n);
    store_first(b->inverse[c], model + (INVERSE + c) * plane, n);
    store_first(b->middle[c] * b->inverse[c], model + (MIDDLE + c) * plane, n);
  }
}

// Windows of cells [0, columns) x [0, rows). ridge, least: see solve().
kernel void bmfr_fit(global const float* restrict cells, int stride, long plane, int columns, int rows, float epsilon,
                     float ridge, float least, global float* restrict models) {
  const int j = get_global_id(1);
  if (j + 1 >= rows) return;
  FOR_EACH_VECTOR(i, 0, columns - 1) {
    global const float* cell[4];
    for (int q = 0; q < 4; ++q) cell[q] = cells + (long)(j + q / 2) * stride + i + q % 2;
    const Basis basis = basis_of(cell, plane);
    Matrix total, one;
    for (int q = 0; q < 4; ++q) {
      read_sums(cell[q] + (ROLES > 1 ? q : 0) * SUMS * plane, plane, one);
      change_basis(cell[q], q, plane, &basis, epsilon, one);
      for (int a = 0; a < COLUMNS; ++a)
        for (int b = 0; b < WIDTH; ++b) total[a][b] = q == 0 ? one[a][b] : total[a][b] + one[a][b];
    }
    solve(total, ridge, least);
    store_model(total, &basis, models + (long)j * stride + i, plane, columns - 1 - i);
  }
}
