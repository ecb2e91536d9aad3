// SPDX-License-Identifier: Apache-2.0
// The guided image filter of Bauszat et al. 2011: box sums along rows, then along columns.
//   values: 0 is 1 at valid pixels   1..3 unit normal, 4 scaled depth: the guidance   5..7 illumination; else 0
//   sums: of windows' rows, MOMENTS planes: 0 count   1..4 guidance   5..14 its products   15..17 illumination
//         18..29 its products with the guidance, light by light; later FIT planes: of the fits
//   fit: 0..11 slopes, light by light   12..14 constant   15 pixels in the window
// A sum's terms are added from left to right, or from the top down, whatever tile they are in.

#define GUIDES 4
#define PRODUCTS 10
#define FIT 15
#define MOMENTS 30

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict values, int stride,
                    long plane, long origin, float depth_scale) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    vi valid = ordinary(depth) & (depth < (vf)SKY);
    vf light[3], normal[3], norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      valid &= ordinary(color) & ordinary(emission) & ordinary(albedo) & ordinary(normal[c]);
      light[c] = (color - emission) / albedo_floored(albedo);
      norm = fma(normal[c], normal[c], norm);
    }
    const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
    store(valid ? (vf)1.0f : (vf)0.0f, values + p);
    for (int c = 0; c < 3; ++c) {
      store(valid ? normal[c] * scale : (vf)0.0f, values + (1 + c) * plane + p);
      store(valid ? light[c] : (vf)0.0f, values + (5 + c) * plane + p);
    }
    store(valid ? depth * depth_scale : (vf)0.0f, values + 4 * plane + p);
  }
}

// Count, guidance and its products.
void sum_guides(global const float* values, global float* sums, long plane, size_t p, int radius) {
  vf count = 0.0f, first[GUIDES], second[PRODUCTS];
  for (int k = 0; k < GUIDES; ++k) first[k] = 0.0f;
  for (int k = 0; k < PRODUCTS; ++k) second[k] = 0.0f;
#pragma nounroll
  for (int i = -radius; i <= radius; ++i) {
    vf g[GUIDES];
    count += load(values + p + i);
#pragma unroll
    for (int k = 0; k < GUIDES; ++k) {
      g[k] = load(values + (1 + k) * plane + p + i);
      first[k] += g[k];
#pragma unroll
      for (int l = 0; l <= k; ++l) second[k * (k + 1) / 2 + l] = fma(g[k], g[l], second[k * (k + 1) / 2 + l]);
    }
  }
  store(count, sums + p);
  for (int k = 0; k < GUIDES; ++k) store(first[k], sums + (1 + k) * plane + p);
  for (int k = 0; k < PRODUCTS; ++k) store(second[k], sums + (1 + GUIDES + k) * plane + p);
}

// Illumination and its products with the guidance.
void sum_light(global const float* values, global float* sums, long plane, size_t p, int radius) {
  vf first[3], second[3 * GUIDES];
  for (int k = 0; k < 3; ++k) first[k] = 0.0f;
  for (int k = 0; k < 3 * GUIDES; ++k) second[k] = 0.0f;
#pragma nounroll
  for (int i = -radius; i <= radius; ++i) {
    vf g[GUIDES];
#pragma unroll
    for (int k = 0; k < GUIDES; ++k) g[k] = load(values + (1 + k) * plane + p + i);
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      const vf light = load(values + (5 + c) * plane + p + i);
      first[c] += light;
#pragma unroll
      for (int k = 0; k < GUIDES; ++k) second[c * GUIDES + k] = fma(light, g[k], second[c * GUIDES + k]);
    }
  }
  const int at = 1 + GUIDES + PRODUCTS;
  for (int k = 0; k < 3; ++k) store(first[k], sums + (at + k) * plane + p);
  for (int k = 0; k < 3 * GUIDES; ++k) store(second[k], sums + (at + 3 + k) * plane + p);
}

kernel void guided_moments(global const float* restrict values, global float* restrict sums, int stride, long plane,
                           long origin, int x0, int y0, int x1, int y1, int radius) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    sum_guides(values, sums, plane, p, radius);
    sum_light(values, sums, plane, p, radius);
  }
}

// Of `count` planes, the rows from `first` to `last` below p's.
void sum_columns(vf* total, int count, global const float* sums, int stride, long plane, size_t p, int first,
                 int last) {
  for (int k = 0; k < count; k += 5) {
    vf part[5];
    for (int l = 0; l < 5; ++l) part[l] = 0.0f;
#pragma nounroll
    for (int j = first; j <= last; ++j) {
#pragma unroll
      for (int l = 0; l < 5; ++l) part[l] += load(sums + (k + l) * plane + p + (long)j * stride);
    }
    for (int l = 0; l < 5; ++l) total[k + l] = part[l];
  }
}

// The lower triangle of a symmetric matrix, row by row, becomes that of its factors L D L^T with 1 / D on the diagonal.
void factor(vf* m) {
#pragma unroll
  for (int k = 0; k < GUIDES; ++k) {
    vf* row = m + k * (k + 1) / 2;
    vf pivot = row[k];
    for (int l = 0; l < k; ++l) {
      const vf* other = m + l * (l + 1) / 2;
      for (int j = 0; j < l; ++j) row[l] = fma(-row[j], other[j], row[l]);  // L D so far
    }
    for (int l = 0; l < k; ++l) {
      const vf scaled = row[l] * m[l * (l + 1) / 2 + l];
      pivot = fma(-scaled, row[l], pivot);
      row[l] = scaled;
    }
    row[k] = 1.0f / pivot;
  }
}

void solve(const vf* m, vf* b) {
#pragma unroll
  for (int k = 1; k < GUIDES; ++k)
    for (int l = 0; l < k; ++l) b[k] = fma(-m[k * (k + 1) / 2 + l], b[l], b[k]);
#pragma unroll
  for (int k = GUIDES - 1; k >= 0; --k) {
    b[k] *= m[k * (k + 1) / 2 + k];
    for (int l = k + 1; l < GUIDES; ++l) b[k] = fma(-m[l * (l + 1) / 2 + k], b[l], b[k]);
  }
}

// In the window about each valid pixel: slopes (Cov(g, g) + epsilon I)^-1 Cov(g, light), constant mean(light) -
// slopes . mean(g). Windows are cut at the frame: rows counts those of the outer region.
kernel void guided_fit(global const float* restrict values, global const float* restrict sums,
                       global float* restrict fit, int stride, long plane, long origin, int x0, int y0, int x1, int y1,
                       int rows, int radius, float epsilon) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  const int first = max(-radius, -y), last = min(radius, rows - 1 - y);
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(values + p) > (vf)0.0f;
    vf s[MOMENTS], covariance[PRODUCTS];
    sum_columns(s, MOMENTS, sums, stride, plane, p, first, last);
    const vf share = 1.0f / (valid ? s[0] : (vf)1.0f);
    vf* guide = s + 1;
    vf* light = s + 1 + GUIDES + PRODUCTS;
    for (int k = 0; k < GUIDES; ++k) guide[k] *= share;
    for (int k = 0; k < GUIDES; ++k)
      for (int l = 0; l <= k; ++l) {
        const int at = k * (k + 1) / 2 + l;
        covariance[at] = fma(s[1 + GUIDES + at], share, -guide[k] * guide[l]) + (k == l ? epsilon : 0.0f);
      }
    factor(covariance);
    for (int c = 0; c < 3; ++c) {
      const vf mean = light[c] * share;
      vf slope[GUIDES], constant_term = mean;
      for (int k = 0; k < GUIDES; ++k) slope[k] = fma(light[3 + c * GUIDES + k], share, -guide[k] * mean);
      solve(covariance, slope);
      for (int k = 0; k < GUIDES; ++k) {
        constant_term = fma(-slope[k], guide[k], constant_term);
        store(valid ? slope[k] : (vf)0.0f, fit + (c * GUIDES + k) * plane + p);
      }
      store(valid ? constant_term : (vf)0.0f, fit + (3 * GUIDES + c) * plane + p);
    }
    store(valid ? s[0] : (vf)0.0f, fit + FIT * plane + p);
  }
}

kernel void guided_rows(global const float* restrict fit, global float* restrict sums, int stride, long plane,
                        long origin, int x0, int y0, int x1, int y1, int radius) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf total[FIT];
    sum_columns(total, FIT, fit, 1, plane, p, -radius, radius);
    for (int k = 0; k < FIT; ++k) store(total[k], sums + k * plane + p);
  }
}

// The mean of the fits of all windows that hold p, at p's guidance. output: RGB over the pixels [left, right) x
// [top, bottom) of the outer region. Invalid pixels keep their colour.
kernel void guided_apply(global const float* restrict input, int w, int h, global const float* restrict values,
                         global const float* restrict sums, global const float* restrict fit, int stride, long plane,
                         long origin, int x0, int y0, int x1, int y1, int left, int top, int right, int bottom,
                         int radius, global float* restrict output) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  const size_t area = (size_t)w * h, out_area = (size_t)(right - left) * (bottom - top);
  const int first = max(-radius, -y), last = min(radius, h - 1 - y);
  FOR_EACH_VECTOR(x, x0, x1) {
    global const float* in = input + (size_t)y * w + x;
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(values + p) > (vf)0.0f;
    vf total[FIT];
    sum_columns(total, FIT, sums, stride, plane, p, first, last);
    const vf share = 1.0f / (valid ? load(fit + FIT * plane + p) : (vf)1.0f);
    for (int c = 0; c < 3; ++c) {
      vf light = total[3 * GUIDES + c];
      for (int k = 0; k < GUIDES; ++k)
        light = fma(total[c * GUIDES + k], load(values + (1 + k) * plane + p), light);
      const vf color = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf positive = light > (vf)0.0f ? light * share : (vf)0.0f;  // beside strong edges a fit overshoots
      const vf filtered = fma(positive, albedo_floored(albedo), emission);
      store_first(filtered_or_kept(valid, filtered, color),
                  output + c * out_area + (size_t)(y - top) * (right - left) + (x - left), n);
    }
  }
}
