// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion, behind rhf.cl: the mean over the pixels, or the patches, that agree. PATCHES: of these.

// 1 where the pixel p agrees with the one (dx, dy) further, else 0.
vf agreed(global const float* pairs, int stride, long plane, size_t p, int dx, int dy) {
  const int later = dy > 0 || (dy == 0 && dx > 0);
  const size_t holder = later ? p : p + (long)dy * stride + dx;
  const vi word = as_vi(load(pairs + (later ? dy : -dy) * plane + holder));
  return (word & (1 << ((later ? dx : -dx) + RADIUS))) != 0 ? (vf)1.0f : (vf)0.0f;
}

#define FOR_EACH_OTHER(dx, dy)                                          \
  _Pragma("nounroll") for (int dy = -RADIUS; dy <= RADIUS; ++dy)         \
      _Pragma("nounroll") for (int dx = -RADIUS; dx <= RADIUS; ++dx)     \
          if (dx != 0 || dy != 0)

// 1 over how many pixels each one's mean is taken of; 0 if it has no samples.
kernel void rhf_count(global const float* restrict pixels, global const float* restrict pairs,
                      global float* restrict shares, int stride, long plane, long origin, int x0, int y0, int x1,
                      int y1) {
  const int y = y0 + (int)get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf count = 1.0f;
    FOR_EACH_OTHER(dx, dy) count += agreed(pairs, stride, plane, p, dx, dy);
    store_first(load(pixels + 3 * plane + p) > (vf)0.0f ? 1.0f / count : (vf)0.0f, shares + p, x1 - x);
  }
}

// The weight of the pixel (dx, dy) further in the mean at p. Of patches: over all that cover p, of which each is the
// mean of those that agree with it.
vf weight(global const float* pixels, global const float* pairs, global const float* shares, int stride, long plane,
          size_t p, int dx, int dy) {
#ifdef PATCHES
  vf sum = 0.0f;
  for (int j = -PATCH; j <= PATCH; ++j)
    for (int i = -PATCH; i <= PATCH; ++i) {
      const size_t centre = p + (long)j * stride + i;
      const vf share = load(shares + centre);
      sum = dx == 0 && dy == 0 ? sum + share
                               : fma(share, agreed(pairs, stride, plane, centre, dx, dy), sum);
    }
  return load(pixels + 3 * plane + p + (long)dy * stride + dx) > (vf)0.0f ? sum : (vf)0.0f;
#else
  return agreed(pairs, stride, plane, p, dx, dy);
#endif
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void rhf_average(global const float* restrict input, int w, int h, global const float* restrict guides,
                        global const float* restrict pixels, global const float* restrict pairs,
                        global const float* restrict shares, int stride, long plane, long origin, int x0, int y0,
                        int x1, int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vf r = load(pixels + p), g = load(pixels + plane + p), b = load(pixels + 2 * plane + p);
#ifdef PATCHES
    vf sum = weight(pixels, pairs, shares, stride, plane, p, 0, 0);
#else
    vf sum = 1.0f;
#endif
    vf total[3] = {0.0f, 0.0f, 0.0f};
    FOR_EACH_OTHER(dx, dy) {
      const size_t q = p + (long)dy * stride + dx;
      const vf k = weight(pixels, pairs, shares, stride, plane, p, dx, dy);
      sum += k;
      total[0] = fma(k, load(pixels + q) - r, total[0]);
      total[1] = fma(k, load(pixels + plane + q) - g, total[1]);
      total[2] = fma(k, load(pixels + 2 * plane + q) - b, total[2]);
    }
    // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
    const vf scale = sum > (vf)0.0f ? 1.0f / sum : (vf)0.0f;
    const vf mean[3] = {fma(total[0], scale, r), fma(total[1], scale, g), fma(total[2], scale, b)};
    const vi valid = load(guides + p) < (vf)INFINITY;
    const int n = x1 - x;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, n, 0.0f);
      store_first(filtered_or_kept(valid, mean[c], color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
