// SPDX-License-Identifier: Apache-2.0
// The filter nlm around the kernels of nlm.cl and nlm_prefilter.cl.
//   valid: 0, or +infinity   signal: of half A, then B: three planes of colour, three of variance (see
//   nlm.cl); or, of all samples, of each channel one of colour and one of variance

#define LARGEST_VARIANCE 1e18f  // products of two stay finite

#ifdef IN_COLOR_A
#define IMAGES 2
#define COLOR(h, c) ((h) == 0 ? IN_COLOR_A + (c) : IN_COLOR_B + (c))
#define VARIANCE(h, c) ((h) == 0 ? IN_COLOR_VARIANCE_A + (c) : IN_COLOR_VARIANCE_B + (c))
#define COLOR_PLANE(h, c) (6 * (h) + (c))
#define VARIANCE_PLANE(h, c) (6 * (h) + 3 + (c))
#else
#define IMAGES 1
#define COLOR(h, c) (IN_COLOR + (c))
#define VARIANCE(h, c) (IN_COLOR_VARIANCE + (c))
#define COLOR_PLANE(h, c) (2 * (c))
#define VARIANCE_PLANE(h, c) (2 * (c) + 1)
#endif

// k: what multiplies the variance, and what is added to it.
kernel void prepare(global const float* restrict input, int w, int h, global float* restrict valid,
                    global float* restrict signal, int stride, long plane, long origin, float2 k) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    vf color[IMAGES][3], variance[IMAGES][3];
    vi is_valid = -1;
    // Population variance of the mean, as in the prefilter's source: the film's is that of a sample.
    vf scale = k.x;
#ifdef IN_SAMPLES
    const vf samples = load_first(in + IN_SAMPLES * area, n, 0.0f);
    is_valid &= ordinary(samples);
    scale *= samples > (vf)1.0f ? (samples - 1.0f) / samples : (vf)0.0f;
#endif
    for (int i = 0; i < IMAGES; ++i)
      for (int c = 0; c < 3; ++c) {
        color[i][c] = load_first(in + COLOR(i, c) * area, n, INFINITY);
        const vf v = load_first(in + VARIANCE(i, c) * area, n, 0.0f);
        is_valid &= ordinary(color[i][c]) & (v >= (vf)0.0f) & (v <= (vf)INFINITY);
        const vf scaled = v * scale;
        variance[i][c] = (scaled < (vf)LARGEST_VARIANCE ? scaled : (vf)LARGEST_VARIANCE) + k.y;
      }
    for (int i = 0; i < IMAGES; ++i)
      for (int c = 0; c < 3; ++c) {
        store(is_valid ? color[i][c] : (vf)0.0f, signal + COLOR_PLANE(i, c) * plane + p);
        store(is_valid ? variance[i][c] : (vf)0.0f, signal + VARIANCE_PLANE(i, c) * plane + p);
      }
    store(is_valid ? (vf)0.0f : (vf)INFINITY, valid + p);
  }
}

// filtered: of each image three planes. output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region,
// the mean of both halves. A pixel that is not valid keeps its colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict valid,
                   global const float* restrict filtered, int stride, long plane, long origin, int x0, int y0,
                   int x1, int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    global const float* in = input + (size_t)y * w + x;
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi is_valid = load(valid + p) < (vf)INFINITY;
    for (int c = 0; c < 3; ++c) {
      vf result = load(filtered + c * plane + p), color = load_first(in + COLOR(0, c) * area, n, 0.0f);
#if IMAGES == 2
      result = 0.5f * (result + load(filtered + (3 + c) * plane + p));
      color = 0.5f * (color + load_first(in + COLOR(1, c) * area, n, 0.0f));
#endif
      store_first(filtered_or_kept(is_valid, result, color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
