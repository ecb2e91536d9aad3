// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion, behind rhf.cl: from the picture to its coarser scales, and from a filtered scale to the next
// finer one. Pixel i of scale s lies on the picture's pixel 2^s i. Means are over the pixels that have samples: sky,
// and what lies beyond the frame's border, counts for nothing.
#ifdef SCALES

#define MOST_STEP 4
#define MOST_FAR 7
#define PHASE (2 * VW + MOST_FAR + 1)  // of the columns below VW coarse pixels, every step-th

// exp(-k^2 / (2 sigma^2)), sigma = 0.55 sqrt(step^2 - 1).
constant float kLowPass2[4] = {1.0f, 0.576393791f, 0.110376641f, 0.00702220726f};
constant float kLowPass4[8] = {1.0f,         0.895661402f,  0.643539835f,  0.370932365f,
                               0.171514855f, 0.0636204107f, 0.0189312336f, 0.0045190701f};

float tap(int k, int step) { return step == 2 ? kLowPass2[abs(k)] : kLowPass4[abs(k)]; }

// Gaussian sums of a plane (null: of 1) about VW coarse pixels, the first of which lies on the picture's (x, y). A
// pixel counts once, or once per sample. Columns are summed first, and kept by phase, so that what neighbouring coarse
// pixels read lies side by side.
vf low_pass(global const float* plane, global const float* samples, int stride, int w, int h, int x, int y,
            const int step, const int far, const bool by_samples) {
  float phases[MOST_STEP * PHASE], lanes[VW];
  for (int v = 0; v < step * (VW - 1) + 2 * far + 1; v += VW) {
    vf sum = 0.0f;
    for (int k = -far; k <= far; ++k) {
      if (y + k < 0 || y + k >= h) continue;
      const vf n = load_inside(samples + (y + k) * stride, x - far + v, w);
      const vf value = plane ? load_inside(plane + (size_t)(y + k) * w, x - far + v, w) : (vf)1.0f;
      const vf counted = n > (vf)0.0f ? value : (vf)0.0f;  // what does not may be infinite
      sum = fma(by_samples ? tap(k, step) * n : (vf)tap(k, step), counted, sum);
    }
    store(sum, lanes);
    for (int i = 0; i < VW; ++i) phases[(v + i) % step * PHASE + (v + i) / step] = lanes[i];
  }
  vf total = 0.0f;
  for (int k = 0; k <= 2 * far; ++k)
    total = fma((vf)tap(k - far, step), load(phases + k % step * PHASE + k / step), total);
  return total;
}

// A row of the coarse planes, plane by plane: all at once would be more streams than are fetched ahead. What sums are
// divided by waits where depth and samples come last.
void decimate(global const float* input, int w, int h, global const float* samples, int stride, int left, int y,
              const int step, const int far, float samples_scale, int coarse_w, global float* coarse,
              size_t coarse_area) {
  const size_t area = (size_t)w * h;
#define LOW_PASS(plane, by_samples) \
  low_pass(plane, samples, stride, w, h, left + x * step, y, step, far, by_samples)
#define OF_SHARE load_first(coarse + IN_DEPTH * coarse_area + x, coarse_w - x, 0.0f)
#define OF_SAMPLE load_first(coarse + IN_SAMPLES * coarse_area + x, coarse_w - x, 0.0f)
#define STORE(value, plane) store_first(value, coarse + (plane)*coarse_area + x, coarse_w - x)
  FOR_EACH_VECTOR(x, 0, coarse_w) {
    const vf all = LOW_PASS(0, false), all_samples = LOW_PASS(0, true);
    STORE(all > (vf)0.0f ? 1.0f / all : (vf)0.0f, IN_DEPTH);
    STORE(all > (vf)0.0f ? 1.0f / all_samples : (vf)0.0f, IN_SAMPLES);
  }
  for (int b = 0; b < BINS; ++b)
    FOR_EACH_VECTOR(x, 0, coarse_w)
      STORE(OF_SAMPLE * LOW_PASS(input + (IN_HISTOGRAM + b) * area, true), IN_HISTOGRAM + b);
#ifdef GATE
  const int means[9] = {IN_COLOR,      IN_COLOR + 1, IN_COLOR + 2, IN_ALBEDO, IN_ALBEDO + 1,
                        IN_ALBEDO + 2, IN_N,         IN_N + 1,     IN_N + 2};
#else
  const int means[3] = {IN_COLOR, IN_COLOR + 1, IN_COLOR + 2};
#endif
  for (int c = 0; c < (int)(sizeof(means) / sizeof(int)); ++c)
    FOR_EACH_VECTOR(x, 0, coarse_w)
      STORE(OF_SHARE * LOW_PASS(input + means[c] * area, false), means[c]);
  FOR_EACH_VECTOR(x, 0, coarse_w) {
    const vf share = OF_SHARE;
    STORE(samples_scale * LOW_PASS(0, true) * share, IN_SAMPLES);
    STORE(share > (vf)0.0f ? (vf)0.0f : (vf)INFINITY, IN_DEPTH);
  }
}

// coarse: the input's planes over coarse_w x coarse_h pixels, the first of which lies on the picture's (left, top).
// `samples_scale` pixels of the picture make one.
kernel void rhf_decimate(global const float* restrict input, int w, int h, global const float* restrict pixels,
                         int stride, long plane, long origin, int step, int left, int top, float samples_scale,
                         int coarse_w, int coarse_h, global float* restrict coarse) {
  const int row = get_global_id(1), y = top + row * step;
  const size_t coarse_area = (size_t)coarse_w * coarse_h;
  global const float* samples = pixels + 3 * plane + origin;
  global float* out = coarse + (size_t)row * coarse_w;
  if (row >= coarse_h) return;
  if (step == 2)
    decimate(input, w, h, samples, stride, left, y, 2, 3, samples_scale, coarse_w, out, coarse_area);
  else
    decimate(input, w, h, samples, stride, left, y, 4, 7, samples_scale, coarse_w, out, coarse_area);
}

// A pixel of RGB planes over the pixels [x0, x1) x [y0, y1).
#define PIXEL_OF(x0, y0, x1, x, y) ((size_t)((y) - (y0)) * ((x1) - (x0)) + ((x) - (x0)))
#define AREA_OF(x0, y0, x1, y1) ((size_t)((x1) - (x0)) * ((y1) - (y0)))

// What a scale's filtered light has, over its pixels [x0, x1) x [y0, y1), beyond the finer scale's, decimated; 0 where
// either has nothing. The first coarse pixel lies on the fine one `first`. In place in `result`.
kernel void rhf_differ(global const float* restrict fine, int fx0, int fy0, int fx1, int fy1,
                       global const float* restrict pixels, int stride, long plane, long origin, int2 first,
                       global const float* restrict coarse_pixels, int coarse_stride, long coarse_plane,
                       long coarse_origin, int x0, int y0, int x1, int y1, global float* restrict result) {
  const int y = y0 + (int)get_global_id(1);
  const size_t fine_area = AREA_OF(fx0, fy0, fx1, fy1), area = AREA_OF(x0, y0, x1, y1);
  if (y >= y1) return;
  for (int x = x0 + (int)get_global_id(0); x < x1; x += (int)get_global_size(0)) {
    float all = 0.0f, sums[3] = {0.0f, 0.0f, 0.0f};
    for (int j = -3; j <= 3; ++j)
      for (int i = -3; i <= 3; ++i) {
        const int fx = 2 * x + first.x + i, fy = 2 * y + first.y + j;
        if (fx < fx0 || fx >= fx1 || fy < fy0 || fy >= fy1) continue;
        if (!(pixels[3 * plane + origin + (long)fy * stride + fx] > 0.0f)) continue;
        const float weight = kLowPass2[abs(i)] * kLowPass2[abs(j)];
        all += weight;
        for (int c = 0; c < 3; ++c)
          sums[c] = fma(weight, fine[c * fine_area + PIXEL_OF(fx0, fy0, fx1, fx, fy)], sums[c]);
      }
    const float samples = coarse_pixels[3 * coarse_plane + coarse_origin + (long)y * coarse_stride + x];
    for (int c = 0; c < 3; ++c) {
      global float* at = result + c * area + PIXEL_OF(x0, y0, x1, x, y);
      *at = samples > 0.0f && all > 0.0f ? *at - sums[c] / all : 0.0f;
    }
  }
}

// The coarse pixel number v of a row or column of the frame's [begin, end), which is reflected beyond its ends.
int reflected(int v, int begin, int end) {
  while (v < begin || v >= end) v = v < begin ? 2 * begin - 1 - v : 2 * end - 1 - v;
  return v;
}

// Keys' bicubic (a = -1/2) half way between two of four.
constant float kHalfWay[4] = {-0.0625f, 0.5625f, 0.5625f, -0.0625f};

// Adds a coarse scale's differences, over [cx0, cx1) x [cy0, cy1) of its frame's pixels [gx0, gx1) x [gy0, gy1), to the
// pixels [x0, x1) x [y0, y1) of the fine one.
kernel void rhf_merge(global const float* restrict fine, int fx0, int fy0, int fx1, int fy1,
                      global const float* restrict pixels, int stride, long plane, long origin, int2 first,
                      global const float* restrict coarse, int cx0, int cy0, int cx1, int cy1, int gx0, int gy0,
                      int gx1, int gy1, int x0, int y0, int x1, int y1, global float* restrict output) {
  const int y = y0 + (int)get_global_id(1);
  const size_t fine_area = AREA_OF(fx0, fy0, fx1, fy1), coarse_area = AREA_OF(cx0, cy0, cx1, cy1),
               area = AREA_OF(x0, y0, x1, y1);
  if (y >= y1) return;
  for (int x = x0 + (int)get_global_id(0); x < x1; x += (int)get_global_size(0)) {
    const int dx = x - first.x, dy = y - first.y, between_x = dx & 1, between_y = dy & 1;
    float sums[3] = {0.0f, 0.0f, 0.0f};
    for (int j = between_y ? -1 : 0; j <= (between_y ? 2 : 0); ++j)
      for (int i = between_x ? -1 : 0; i <= (between_x ? 2 : 0); ++i) {
        const int cx = reflected((dx >> 1) + i, gx0, gx1), cy = reflected((dy >> 1) + j, gy0, gy1);
        const float weight = (between_x ? kHalfWay[i + 1] : 1.0f) * (between_y ? kHalfWay[j + 1] : 1.0f);
        for (int c = 0; c < 3; ++c)
          sums[c] = fma(weight, coarse[c * coarse_area + PIXEL_OF(cx0, cy0, cx1, cx, cy)], sums[c]);
      }
    const bool sampled = pixels[3 * plane + origin + (long)y * stride + x] > 0.0f;
    for (int c = 0; c < 3; ++c) {
      const float own = fine[c * fine_area + PIXEL_OF(fx0, fy0, fx1, x, y)];
      output[c * area + PIXEL_OF(x0, y0, x1, x, y)] = sampled ? own + sums[c] : own;
    }
  }
}

#endif
