// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion: which pixels agree, by the chi-square distance of their samples' histograms.
//   guides: 0 is +infinity at invalid pixels, else 0; with GATE also 1..3 albedo   4..6 normal, in units of the gate
//   pixels: 0..2 colour   3 samples n (0 at invalid pixels)   4, 5 which bins are filled, 30 bits each
//   pairs: per dy of 0..RADIUS a plane of words: bit dx + RADIUS is set if the pixel (dx, dy) further agrees. Of dy = 0
//   only dx > 0: of each pair, the pixel that comes first in the picture holds the bit.
// RADIUS, PATCH: of the window, of the patches. SHARED: only bins of more than one sample count. COLUMNS, ROWS: of the
// blocks in which pixels are compared; MARGIN: on either side; STRIDE: from a bin of a row to the next; HISTORY_FLOATS,
// BLOCK_FLOATS: of a block's histograms, of all its working memory.

#define BINS 60
#define SIDE (2 * PATCH + 1)
#define WINDOW (2 * RADIUS + 1)

#if VW == 1
#define convert_vf convert_float
#else
#define convert_vf JOIN(convert_float, VW)
#endif

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict pixels, int stride, long plane, long origin, float albedo_scale,
                    float normal_scale) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    const vf samples = load_first(in + IN_SAMPLES * area, n, 0.0f);
    vi valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(samples) & (samples >= (vf)0.0f);
    vf color[3];
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      valid &= ordinary(color[c]);
    }
    vi filled[2] = {0, 0};
    for (int b = 0; b < BINS; ++b) {
      const vf bin = load_first(in + (IN_HISTOGRAM + b) * area, n, 0.0f);
      valid &= ordinary(bin) & (bin >= (vf)0.0f);
      filled[b / 30] |= bin > (vf)0.0f ? (vi)(1 << b % 30) : (vi)0;
    }
#ifdef GATE
    for (int c = 0; c < 3; ++c)
      valid &= ordinary(load_first(in + (IN_ALBEDO + c) * area, n, 0.0f)) &
               ordinary(load_first(in + (IN_N + c) * area, n, 0.0f));
    for (int c = 0; c < 3; ++c) {
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf normal = load_first(in + (IN_N + c) * area, n, 0.0f);
      store(valid ? albedo * albedo_scale : (vf)0.0f, guides + (1 + c) * plane + p);
      store(valid ? normal * normal_scale : (vf)0.0f, guides + (4 + c) * plane + p);
    }
#endif
    store(valid ? (vf)0.0f : (vf)INFINITY, guides + p);
    for (int c = 0; c < 3; ++c) store(valid ? color[c] : (vf)0.0f, pixels + c * plane + p);
    store(valid ? samples : (vf)0.0f, pixels + 3 * plane + p);
    for (int k = 0; k < 2; ++k) store(as_vf(valid ? filled[k] : (vi)0), pixels + (4 + k) * plane + p);
  }
}

// 1 / x within 1e-7, for ordinary x > 0: division would take longer than all the rest. The exponent's negative and a
// line through the mantissa are within 5.1 %; a step of third and one of second order follow.
vf reciprocal(vf x) {
  vf y = as_vf((vi)0x7ef311c0 - as_vi(x));
  vf e = fma(-x, y, (vf)1.0f);
  y = fma(y, fma(e, e, e), y);
  e = fma(-x, y, (vf)1.0f);
  return fma(y, e, y);
}

// VW pixels of a row from x on, 0 beyond its ends.
vf load_inside(global const float* row, int x, int w) {
  if (x >= 0 && x + VW <= w) return load(row + x);
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = x + k >= 0 && x + k < w ? row[x + k] : 0.0f;
  return load(lanes);
}

// Brings row y of the picture, from column x on, into `history`; behind its bins, per vector, which fours of bins hold
// anything.
void keep_row(global const float* input, int w, int h, int x, int y, global float* history) {
  const size_t area = (size_t)w * h;
  for (int v = 0; v < COLUMNS + 2 * MARGIN; v += VW) {
    int fours = 0;
    for (int four = 0; four < BINS / 4; ++four) {
      vf sum = 0.0f;
      for (int b = 4 * four; b < 4 * four + 4; ++b) {
        const vf bin = y >= 0 && y < h ? load_inside(input + (IN_HISTOGRAM + b) * area + (size_t)y * w, x + v, w) : (vf)0.0f;
        store(bin, history + b * STRIDE + v);
        sum += bin;
      }
      fours |= any_lane(sum != (vf)0.0f) ? 1 << four : 0;
    }
    history[(BINS * STRIDE) + v / VW] = as_float(fours);
  }
}

// Which fours of bins hold anything in a vector at v, or within RADIUS of one in the other row.
int fours_of(global const float* first, global const float* second, int v) {
  int fours = as_int(first[(BINS * STRIDE) + v / VW]);
  for (int k = -((RADIUS + VW - 1) / VW); k <= (RADIUS + VW - 1) / VW; ++k)
    fours |= as_int(second[(BINS * STRIDE) + v / VW + k]);
  return fours;
}

// An empty bin of the first pixel counts as this share of its samples in denominators, which so never are 0.
#define TINY 0x1p-30f

// Adds to distances[k] that of the pixels at `first` and k further than `second`, for k < count. With shares f of n
// samples, a bin's term (sqrt(n_q / n_p) h_p - sqrt(n_p / n_q) h_q)^2 / (h_p + h_q) is n_q (f_p - f_q)^2 / (f_p + r f_q),
// r = n_q / n_p. Four terms share a reciprocal.
#define ADD_DISTANCES(count)                                                                        \
  _Pragma("nounroll") for (int four = 0; four < BINS / 4; ++four) {                                  \
    if (!(fours >> four & 1)) continue;                                                             \
    global const float* a = first + 4 * four * STRIDE;                                              \
    global const float* b = second + 4 * four * STRIDE;                                             \
    vf f[4], floored[4];                                                                            \
    _Pragma("unroll") for (int i = 0; i < 4; ++i) {                                                 \
      f[i] = load(a + i * STRIDE);                                                                  \
      floored[i] = f[i] > (vf)TINY ? f[i] : (vf)TINY;                                               \
    }                                                                                               \
    _Pragma("unroll") for (int k = 0; k < count; ++k) {                                             \
      vf square[4], sum[4];                                                                         \
      _Pragma("unroll") for (int i = 0; i < 4; ++i) {                                               \
        const vf g = load(b + i * STRIDE + k);                                                      \
        const vf d = f[i] - g;                                                                      \
        sum[i] = fma(ratio[k], g, floored[i]);                                                      \
        square[i] = d * d;                                                                          \
        COUNT_TERM                                                                                  \
      }                                                                                             \
      const vf n01 = fma(square[0], sum[1], square[1] * sum[0]), d01 = sum[0] * sum[1];             \
      const vf n23 = fma(square[2], sum[3], square[3] * sum[2]), d23 = sum[2] * sum[3];             \
      distances[k] = fma(fma(n01, d23, n23 * d01), reciprocal(d01 * d23), distances[k]);            \
    }                                                                                               \
  }

#ifdef SHARED
#define COUNT_TERM                               \
  const vi counts = sum[i] > more_than_one;      \
  square[i] = counts ? square[i] : (vf)0.0f;     \
  terms[k] += counts ? (vi)1 : (vi)0;
#else
#define COUNT_TERM
#endif

// How many bits of both words are set; of up to 63. Lane by lane: the library's popcount takes one lane at a time.
vi bits_of(vi a, vi b) {
  const vi pairs = 0x55555555, fours = 0x33333333, eights = 0x0f0f0f0f;
  a -= a >> 1 & pairs;
  b -= b >> 1 & pairs;
  a = (a & fours) + (a >> 2 & fours) + (b & fours) + (b >> 2 & fours);
  a = (a & eights) + (a >> 4 & eights);
  return a * 0x01010101 >> 24;
}

// How far the pixels at p and q, ..., q + count - 1 are beyond the threshold, summed over the bins: chi-square minus
// threshold times bins; 0 if either has no samples. Into as many maps.
#define COMPARE(name, count)                                                                                    \
  void name(global const float* pixels, long plane, size_t p, size_t q, float threshold,                        \
            global const float* first, global const float* second, int fours, global float* maps) {             \
    const vf n = load(pixels + 3 * plane + p), one_sample = n > (vf)0.0f ? 1.0f / n : (vf)0.0f;                  \
    const vf more_than_one = 1.000001f * one_sample;                                                            \
    vf ratio[count], distances[count];                                                                          \
    vi terms[count];                                                                                            \
    _Pragma("unroll") for (int k = 0; k < count; ++k) {                                                         \
      ratio[k] = load(pixels + 3 * plane + q + k) * one_sample;                                                 \
      distances[k] = 0.0f;                                                                                      \
      terms[k] = 0;                                                                                             \
    }                                                                                                           \
    ADD_DISTANCES(count)                                                                                        \
    _Pragma("unroll") for (int k = 0; k < count; ++k) {                                                         \
      const vf other_n = load(pixels + 3 * plane + q + k);                                                      \
      const vi sampled = (n > (vf)0.0f) & (other_n > (vf)0.0f);                                                 \
      const vf bins = convert_vf(BINS_OF(k));                                                                   \
      const vf beyond = fma(other_n, distances[k], -threshold * bins);                                          \
      store(sampled ? beyond : (vf)0.0f, maps + k * SIDE * COLUMNS);                                            \
    }                                                                                                           \
  }

#ifdef SHARED
#define BINS_OF(k) terms[k]
#else
#define BINS_OF(k)                                                                            \
  bits_of(as_vi(load(pixels + 4 * plane + p)) | as_vi(load(pixels + 4 * plane + q + k)),      \
          as_vi(load(pixels + 5 * plane + p)) | as_vi(load(pixels + 5 * plane + q + k)))
#endif

COMPARE(compare_row, RADIUS)
COMPARE(compare_pixel, 1)

// The kept row of the picture, one of `count`.
int slot(int y, int count) { return (y + 16 * count) % count; }

// Whether the pixels at p and q may agree at all.
vi comparable(global const float* guides, global const float* pixels, long plane, size_t p, size_t q) {
  vi may = (load(pixels + 3 * plane + p) > (vf)0.0f) & (load(pixels + 3 * plane + q) > (vf)0.0f);
#ifdef GATE
#pragma unroll
  for (int c = 1; c < 7; ++c) may &= fabs(load(guides + c * plane + p) - load(guides + c * plane + q)) <= (vf)1.0f;
#endif
  return may;
}

// Sums the maps of dy over the patches about the pixels of row y, and keeps who agrees. The block's columns start at x.
void agree(global const float* guides, global const float* pixels, int stride, long plane, long origin, int x, int y,
           int columns, int dy, global const float* maps, global float* sums, global float* pairs) {
  for (int dx = dy == 0 ? 1 : -RADIUS; dx <= RADIUS; ++dx) {
    global const float* map = maps + (size_t)(dy * WINDOW + dx + RADIUS) * SIDE * COLUMNS;
    for (int v = 0; v < columns + 2 * PATCH; v += VW) {
      vf sum = 0.0f;
      for (int k = -PATCH; k <= PATCH; ++k) sum += load(map + slot(y + k, SIDE) * COLUMNS + v);
      store(sum, sums + (dx + RADIUS) * COLUMNS + v);
    }
  }
  for (int v = 0; v < columns; v += VW) {
    const size_t p = origin + (size_t)y * stride + x + v;
    vi word = 0;
    for (int dx = dy == 0 ? 1 : -RADIUS; dx <= RADIUS; ++dx) {
      vf sum = 0.0f;
      for (int k = 0; k < SIDE; ++k) sum += load(sums + (dx + RADIUS) * COLUMNS + v + k);
      const vi same = (sum < (vf)0.0f) & comparable(guides, pixels, plane, p, p + (size_t)dy * stride + dx);
      word |= same ? (vi)(1 << (dx + RADIUS)) : (vi)0;
    }
    store_first(as_vf(word), pairs + dy * plane + p, columns - v);
  }
}

// Who agrees with whom, of the pixels [x0, x1) x [y0, y1) and those after them in the window. A work-item per block.
kernel void rhf_compare(global const float* restrict input, int w, int h, global const float* restrict guides,
                        global const float* restrict pixels, int stride, long plane, long origin, int x0, int y0,
                        int x1, int y1, float threshold, global float* restrict memory, global float* restrict pairs) {
  const int inner = COLUMNS - 2 * PATCH, across = (x1 - x0 + inner - 1) / inner;
  const int block = get_global_id(1), x = x0 + block % across * inner, top = y0 + block / across * ROWS;
  if (get_global_id(0) != 0 || top >= y1) return;
  const int bottom = top + ROWS < y1 ? top + ROWS : y1, columns = x + inner < x1 ? inner : x1 - x;
  global float* history = memory + (size_t)block * BLOCK_FLOATS;
  global float* maps = history + HISTORY_FLOATS;
  global float* sums = maps + (RADIUS + 1) * WINDOW * SIDE * COLUMNS;
  for (int y = top - PATCH; y < bottom + PATCH; ++y) {
    for (int k = y == top - PATCH ? 0 : RADIUS; k <= RADIUS; ++k)
      keep_row(input, w, h, x - PATCH - MARGIN, y + k, history + slot(y + k, RADIUS + 1) * (BINS + 1) * STRIDE);
    global const float* first = history + slot(y, RADIUS + 1) * (BINS + 1) * STRIDE;
    for (int v = 0; v < columns + 2 * PATCH; v += VW)
      for (int dy = 0; dy <= RADIUS; ++dy) {
        global const float* second = history + slot(y + dy, RADIUS + 1) * (BINS + 1) * STRIDE;
        const int fours = fours_of(first, second, MARGIN + v);
        const size_t p = origin + (long)y * stride + x - PATCH + v, q = p + dy * stride;
        global float* map = maps + (size_t)((dy * WINDOW + RADIUS) * SIDE + slot(y, SIDE)) * COLUMNS + v;
        global const float *a = first + MARGIN + v, *b = second + MARGIN + v;
        // Left and right of the pixel dy rows further; of its own row only right.
        for (int dx = dy == 0 ? 1 : -RADIUS; dx <= 1; dx += RADIUS + 1)
          compare_row(pixels, plane, p, q + dx, threshold, a, b + dx, fours, map + dx * SIDE * COLUMNS);
        if (dy > 0) compare_pixel(pixels, plane, p, q, threshold, a, b, fours, map);
      }
    if (y < top + PATCH) continue;
    for (int dy = 0; dy <= RADIUS; ++dy)
      agree(guides, pixels, stride, plane, origin, x, y - PATCH, columns, dy, maps, sums, pairs);
  }
}
