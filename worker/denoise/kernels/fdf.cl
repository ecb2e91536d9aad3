// SPDX-License-Identifier: Apache-2.0
// The Feature Distance Filter (Lardinoije, section 4.2).
//   valid:   0, or +infinity   guides: 0..2 albedo   3..5 normal, mapped to 0..1   6 shading   7 root of
//   samples signals: of the shading, and of each of the other guides if FDF_SIGNALS is 7, value and variance:
//   see
//            nlm_prefilter.cl   colour: RGB

#define LARGEST_VARIANCE 1e18f

// Population variance of the mean, kept where products of two stay finite, and what the prefilter adds.
vf fdf_variance(vf variance, vf samples, float scale, float added) {
  const vf population = variance * (samples > (vf)1.0f ? (samples - 1.0f) / samples : (vf)0.0f) * scale;
  return (population < (vf)LARGEST_VARIANCE ? population : (vf)LARGEST_VARIANCE) + added;
}

// k: 1 / light, epsilon / 2.
kernel void prepare(global const float* restrict input, int w, int h, global float* restrict valid,
                    global float* restrict guides, global float* restrict signals,
                    global float* restrict colors, int stride, long plane, long origin, float2 k) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    const vf samples = load_first(in + IN_SAMPLES * area, n, 0.0f);
    vf color[3], guide[7], variance[7];
    guide[6] = load_first(in + IN_SHADING * area, n, 0.0f) * k.x;
    variance[0] = load_first(in + IN_SHADING_VARIANCE * area, n, 0.0f);
    vi is_valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(samples) & ordinary(guide[6]);
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      guide[c] = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      guide[3 + c] = fma(load_first(in + (IN_N + c) * area, n, 0.0f), (vf)0.5f, (vf)0.5f);
      is_valid &= ordinary(color[c]) & ordinary(guide[c]) & ordinary(guide[3 + c]);
#if FDF_SIGNALS == 7
      variance[1 + c] = load_first(in + (IN_ALBEDO_VARIANCE + c) * area, n, 0.0f);
      variance[4 + c] = load_first(in + (IN_N_VARIANCE + c) * area, n, 0.0f);
#endif
    }
    for (int s = 0; s < FDF_SIGNALS; ++s)
      is_valid &= (variance[s] >= (vf)0.0f) & (variance[s] <= (vf)INFINITY);
    for (int s = 0; s < FDF_SIGNALS; ++s) {
      const float scale = s == 0 ? k.x * k.x : s > 3 ? 0.25f : 1.0f;
      store(is_valid ? guide[s == 0 ? 6 : s - 1] : (vf)0.0f, signals + 2 * s * plane + p);
      store(is_valid ? fdf_variance(variance[s], samples, scale, k.y) : (vf)0.0f,
            signals + (2 * s + 1) * plane + p);
    }
    for (int c = 0; c < 3; ++c) store(is_valid ? color[c] : (vf)0.0f, colors + c * plane + p);
    for (int c = 0; c < 6; ++c) store(is_valid ? guide[c] : (vf)0.0f, guides + c * plane + p);
    store(is_valid ? sqrt(samples) : (vf)0.0f, guides + 7 * plane + p);
    store(is_valid ? (vf)0.0f : (vf)INFINITY, valid + p);
  }
}

vf larger(vf a, vf b) { return a > b ? a : b; }

// The largest difference of three channels.
vf fdf_difference(global const float* guides, long plane, size_t q, const vf* centre) {
  return larger(
      larger(fabs(fetch(guides + q) - centre[0]), fabs(fetch(guides + plane + q) - centre[1])),
      fabs(fetch(guides + 2 * plane + q) - centre[2]));
}

// k: as of fdf_filter.
INLINE void pair_weights(PairPictures s, size_t begin, int row, PairOffsets o, float4 k) {
  FOR_EACH_SHARED(i, o.width) {
    const size_t p = begin + i;
    vf guide[8];
    for (int c = 0; c < 8; ++c) guide[c] = fetch(s.guides + c * s.plane + p);
    const vf shading_scale = guide[7] * k.z, here = fetch(s.valid + p);
#pragma nounroll
    for (int dx = o.first; dx <= o.last; ++dx) {
      const size_t q = p + (long)o.dy * s.stride + dx;
      const vf albedo = fdf_difference(s.guides, s.plane, q, guide) * k.x;
      const vf normal = fdf_difference(s.guides + 3 * s.plane, s.plane, q, guide + 3) * k.y;
      const vf shading = fabs(fetch(s.guides + 6 * s.plane + q) - guide[6]) *
                         (shading_scale * fetch(s.guides + 7 * s.plane + q));
      const vf distance = larger(larger(albedo, normal), larger(shading, here + fetch(s.valid + q)));
      const vf exponent = OF_ONE - distance;
      put(number_of(exponent > (vf)0.0f ? exponent : (vf)0.0f), pair_row(o, row, dx) + i);
    }
  }
}

// k: what is taken off a weight's exponent by the largest differences of albedo, of normals, and of shading at one
// sample. scratch: `room` floats for each work-group.
kernel void fdf_filter(global const float* restrict valid, global const float* restrict guides,
                       global const float* restrict colors, global float* restrict to, int stride, long plane,
                       long origin, int x0, int y0, int x1, int y1, int columns, int rows,
                       global float* restrict scratch, int room, float4 k) {
  const PairPictures s = {guides, valid, colors, plane, stride};
  global float* acc = scratch + (long)group_number() * room;
  for (int n = group_number(); n < tiles_of(x0, y0, x1, y1, columns, rows); n += group_count()) {
    const Tile t = tile_of(n, x0, y0, x1, y1, columns, rows);
    const size_t first = origin + (size_t)t.y * stride + t.x;
    pair_tile(s, first, t, k, acc);
    for (int row = 0; row < t.rows; ++row) FOR_EACH_SHARED(i, t.columns) {
        const size_t p = first + (size_t)row * stride + i;
        vf mean[3];
        pair_mean(s, p, acc + (long)row * t.columns + i, (long)t.columns * t.rows, mean);
        const vi is_valid = fetch(valid + p) < (vf)INFINITY;
        for (int c = 0; c < 3; ++c) put(is_valid ? mean[c] : (vf)0.0f, to + c * plane + p);
      }
    barrier(CLK_GLOBAL_MEM_FENCE);
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict valid,
                   global const float* restrict filtered, int stride, long plane, long origin, int x0, int y0,
                   int x1, int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi is_valid = fetch(valid + p) < (vf)INFINITY;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, n, 0.0f);
      store_first(filtered_or_kept(is_valid, fetch(filtered + c * plane + p), color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
