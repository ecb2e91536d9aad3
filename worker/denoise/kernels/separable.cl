// SPDX-License-Identifier: Apache-2.0
// A window whose weights are a product of one along the row and one along the column. Sums are taken tap by tap in
// one order: running sums would depend on where a tile begins.
//   signal, means: 0..2 colour   3 weight (signal: 1 at valid pixels, else 0)
// WEIGHTS: at distance 0 .. RADIUS along a row or column.

constant float kWeights[] = {WEIGHTS};

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict signal, int stride,
                    long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    vf color[3];
    for (int c = 0; c < 3; ++c)
      color[c] = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, w - x, INFINITY);
    const vi valid = ordinary(color[0]) & ordinary(color[1]) & ordinary(color[2]);
    global float* to = signal + origin + (size_t)y * stride + x;
    for (int c = 0; c < 3; ++c) store(valid ? color[c] : (vf)0.0f, to + c * plane);
    store(valid ? (vf)1.0f : (vf)0.0f, to + 3 * plane);
  }
}

// Weighted sums of the differences from one pixel.
typedef struct {
  vf r, g, b;                // of that pixel
  vf sum, red, green, blue;  // of the weights, of the weighted differences
} Mean;

Mean mean_about(global const float* p, long plane) {
  Mean m;
  m.r = load(p);
  m.g = load(p + plane);
  m.b = load(p + 2 * plane);
  m.sum = m.red = m.green = m.blue = 0.0f;
  return m;
}

Mean with_tap(Mean m, global const float* q, long plane, float weight) {
  const vf w = weight * load(q + 3 * plane);
  m.sum += w;
  m.red = fma(w, load(q) - m.r, m.red);
  m.green = fma(w, load(q + plane) - m.g, m.green);
  m.blue = fma(w, load(q + 2 * plane) - m.b, m.blue);
  return m;
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
Mean finished(Mean m) {
  const vf scale = m.sum > (vf)0.0f ? 1.0f / m.sum : (vf)0.0f;
  m.r = fma(m.red, scale, m.r);
  m.g = fma(m.green, scale, m.g);
  m.b = fma(m.blue, scale, m.b);
  return m;
}

kernel void rows(global const float* restrict signal, global float* restrict means, int stride, long plane,
                 long origin, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    Mean m = mean_about(signal + p, plane);
#pragma unroll
    for (int i = -RADIUS; i <= RADIUS; ++i) m = with_tap(m, signal + p + i, plane, kWeights[i < 0 ? -i : i]);
    m = finished(m);
    store(m.r, means + p);
    store(m.g, means + plane + p);
    store(m.b, means + 2 * plane + p);
    store(m.sum, means + 3 * plane + p);
  }
}

// Only the frame ends within the reach of a column. output: RGB over the pixels [x0, x1) x [y0, y1) of the outer
// region. Invalid pixels keep their colour.
kernel void columns(global const float* restrict input, int w, int h, global const float* restrict signal,
                    global const float* restrict means, int stride, long plane, long origin, int x0, int y0, int x1,
                    int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  const int first = max(-RADIUS, -y), last = min(RADIUS, h - 1 - y);
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    Mean m = mean_about(means + p, plane);
    for (int j = first; j <= last; ++j)
      m = with_tap(m, means + p + (long)j * stride, plane, kWeights[j < 0 ? -j : j]);
    m = finished(m);
    const vf mean[3] = {m.r, m.g, m.b};
    const vi valid = load(signal + 3 * plane + p) > (vf)0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, x1 - x, 0.0f);
      store_first(filtered_or_kept(valid, mean[c], color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), x1 - x);
    }
  }
}
