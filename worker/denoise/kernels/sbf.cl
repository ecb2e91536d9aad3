// SPDX-License-Identifier: Apache-2.0
// SURE-based filtering (Li, Wu and Chuang 2012): a bank of cross-bilateral filters, which share the weights of the
// features, and an estimate of each one's error; these are smoothed, and the least decides.
//   guides: 0 depth (+infinity at invalid pixels)   1..3 normal   4..6 albedo   7..9 variance of each of the three
//   signal: 0..2 colour   3..5 variance of its mean
//   BANK: how many filters   NOISY: whether the unfiltered picture is a candidate too   SMOOTHING: radius
// Features are stored so that a squared difference is its exponent to base 2, and variances in units of the least
// one that counts.
#define CANDIDATES (BANK + NOISY)
#define REACH 17                   // distances along an axis that have spatial weights
#define LARGEST_VARIANCE 1e11f     // of features, in the least one's units; products of three stay finite
#define LARGEST_ERROR 1e34f        // so do sums of a window's
#define TABLE (REACH * REACH)

// Weights of the BANK filters, then of the smoothing, by distance down and across. exponents: log2(e) over twice the
// squared sigma of the first of the bank, each following one's half of that; the same of the smoothing.
kernel void sbf_spatial(float first, float smoothing, global float* restrict spatial) {
  const int k = get_global_id(1);
  if (k > BANK || get_global_id(0) > 0) return;
  const float scale = k == BANK ? smoothing : ldexp(first, -k);
  for (int j = 0; j < REACH; ++j)
    for (int i = 0; i < REACH; ++i) spatial[k * TABLE + j * REACH + i] = exp2(-scale * (float)(i * i + j * j));
}

vf capped(vf v, float largest) { return v < (vf)largest ? v : (vf)largest; }

// scales: of depth, normal and albedo as stored; least: of their variances.
kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict signal, int stride, long plane, long origin, float4 scales, float4 least) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    vf variance[3] = {load_first(in + IN_DEPTH_VARIANCE * area, n, 0.0f), 0.0f, 0.0f};
    vi valid = ordinary(depth) & (depth < (vf)SKY) & (variance[0] >= (vf)0.0f);
    vf color[3], noise[3], normal[3], albedo[3];
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      noise[c] = load_first(in + (IN_COLOR_VARIANCE + c) * area, n, 0.0f);
      normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      albedo[c] = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf of_normal = load_first(in + (IN_N_VARIANCE + c) * area, n, 0.0f);
      const vf of_albedo = load_first(in + (IN_ALBEDO_VARIANCE + c) * area, n, 0.0f);
      valid &= ordinary(color[c]) & ordinary(normal[c]) & ordinary(albedo[c]) & (noise[c] >= (vf)0.0f) &
               (of_normal >= (vf)0.0f) & (of_albedo >= (vf)0.0f);
      variance[1] += of_normal;
      variance[2] += of_albedo;
    }
    store(valid ? depth * scales.x : (vf)INFINITY, guides + p);
    for (int c = 0; c < 3; ++c) {
      store(valid ? normal[c] * scales.y : (vf)0.0f, guides + (1 + c) * plane + p);
      store(valid ? albedo[c] * scales.z : (vf)0.0f, guides + (4 + c) * plane + p);
      const float unit = c == 0 ? least.x : c == 1 ? least.y : least.z;
      store(valid ? capped(variance[c] * unit, LARGEST_VARIANCE) : (vf)0.0f, guides + (7 + c) * plane + p);
      store(valid ? color[c] : (vf)0.0f, signal + c * plane + p);
      store(valid ? capped(noise[c], LARGEST_ERROR) : (vf)0.0f, signal + (3 + c) * plane + p);
    }
  }
}

// Not inlined: the compiler would take the vectors to pieces, as vload16 is made of them, all the way through the loop.
__attribute__((noinline)) void load_features(global const float* guides, long plane, size_t p, vf* f) {
#pragma unroll
  for (int k = 0; k < 10; ++k) f[k] = load(guides + k * plane + p);
}

// For numbers from 1 to 1e34, relative error below 2e-7: Newton's iteration from a guess in the bits.
__attribute__((always_inline)) vf reciprocal(vf v) {
  vf r = as_vf((vi)0x7ef311c7 - as_vi(v));
#pragma unroll
  for (int k = 0; k < 3; ++k) r = fma(r, fma(-v, r, (vf)1.0f), r);
  return r;
}

__attribute__((always_inline)) vf squared_difference(const vf* f, global const float* guides, long plane, size_t q, int first) {
  const vf a = load(guides + first * plane + q) - f[first];
  const vf b = load(guides + (first + 1) * plane + q) - f[first + 1];
  const vf c = load(guides + (first + 2) * plane + q) - f[first + 2];
  return fma(a, a, fma(b, b, c * c));
}

// exp(-sum of |difference|^2 / (2 sigma^2 max(V_p + V_q, least))), the three quotients as one. A call would cost all
// vectors that are in registers.
__attribute__((always_inline)) vf feature_weight(const vf* f, global const float* guides, long plane, size_t q) {
  const vf depth = load(guides + q) - f[0], normal = squared_difference(f, guides, plane, q, 1),
           albedo = squared_difference(f, guides, plane, q, 4);
  vf variance[3];
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    const vf sum = load(guides + (7 + k) * plane + q) + f[7 + k];
    variance[k] = sum > (vf)1.0f ? sum : (vf)1.0f;
  }
  const vf others = variance[1] * variance[2];
  const vf sum = fma(depth * depth, others, variance[0] * fma(normal, variance[2], albedo * variance[1]));
  return exp2_of_negative(-sum * reciprocal(variance[0] * others));
}

// Adds to the filters from number `from` on the taps that are farther than `inner` and at most `outer` away.
// `from` is constant, and all is unrolled along the bank.
#define RING(from, inner, outer)                                                                         \
  if (from < BANK) {                                                                                     \
    _Pragma("nounroll") for (int j = -outer; j <= outer; ++j) {                                          \
      const bool hole = abs(j) <= inner;                                                                 \
      _Pragma("nounroll") for (int i = -outer; i <= outer; ++i) {                                        \
        if (hole && i == -inner) i = inner + 1;                                                          \
        const size_t q = p + (long)j * stride + i;                                                       \
        const vf w = feature_weight(f, guides, plane, q);                                               \
        const vf r = load(signal + q) - center[0], g = load(signal + plane + q) - center[1],             \
                 b = load(signal + 2 * plane + q) - center[2];                                           \
        global const float* distance = spatial + abs(j) * REACH + abs(i);                                \
        _Pragma("unroll") for (int k = from; k < BANK; ++k) {                                            \
          const vf v = w * distance[k * TABLE];                                                          \
          sum[k] += v;                                                                              \
          total[k][0] = fma(v, r, total[k][0]);                                                      \
          total[k][1] = fma(v, g, total[k][1]);                                                      \
          total[k][2] = fma(v, b, total[k][2]);                                                      \
        }                                                                                                \
      }                                                                                                  \
    }                                                                                                    \
  }

// results: of each filter the colours and the estimated error, summed over the channels:
// (F - y)^2 + 2 V dF/dy - V, where dF/dy is the centre's weight, 1, over the sum of weights.
kernel void sbf_bank(global const float* restrict guides, global const float* restrict signal,
                     global const float* restrict spatial, global float* restrict results, int stride, long plane,
                     long origin, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf f[10];
    load_features(guides, plane, p, f);
    vf center[3];
    vf sum[BANK], total[BANK][3];
#pragma unroll
    for (int c = 0; c < 3; ++c) center[c] = load(signal + c * plane + p);
#pragma unroll
    for (int k = 0; k < BANK; ++k) {
      sum[k] = 1.0f;
      total[k][0] = total[k][1] = total[k][2] = 0.0f;
    }
    RING(6, 12, 16)
    RING(5, 8, 12)
    RING(4, 6, 8)
    RING(3, 4, 6)
    RING(2, 3, 4)
    RING(1, 2, 3)
    RING(0, 0, 2)
    const vi valid = f[0] < (vf)INFINITY;
#pragma unroll
    for (int k = 0; k < BANK; ++k) {
      const vf inverse = 1.0f / sum[k];
      vf error = 0.0f;
#pragma unroll
      for (int c = 0; c < 3; ++c) {
        // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
        const vf change = total[k][c] * inverse;
        error += fma(load(signal + (3 + c) * plane + p), fma((vf)2.0f, inverse, (vf)-1.0f), change * change);
        store(valid ? center[c] + change : (vf)0.0f, results + (4 * k + c) * plane + p);
      }
      store(valid ? capped(error, LARGEST_ERROR) : (vf)0.0f, results + (4 * k + 3) * plane + p);
    }
  }
}

// Estimated errors of the candidates about p, summed with the features' weights and the spatial one.
__attribute__((always_inline)) void sum_errors(global const float* guides, global const float* signal,
                                               global const float* spatial, global const float* results, int stride,
                                               long plane, size_t p, vf* error) {
  vf f[10];
  load_features(guides, plane, p, f);
#pragma unroll
  for (int k = 0; k < CANDIDATES; ++k) error[k] = 0.0f;
#pragma nounroll
  for (int j = -SMOOTHING; j <= SMOOTHING; ++j) {
#pragma nounroll
    for (int i = -SMOOTHING; i <= SMOOTHING; ++i) {
      const size_t q = p + (long)j * stride + i;
      const vf weight = feature_weight(f, guides, plane, q) * spatial[BANK * TABLE + abs(j) * REACH + abs(i)];
#pragma unroll
      for (int k = 0; k < BANK; ++k) error[k] = fma(weight, load(results + (4 * k + 3) * plane + q), error[k]);
#if NOISY
#pragma unroll
      for (int c = 3; c < 6; ++c) error[BANK] = fma(weight, load(signal + c * plane + q), error[BANK]);
#endif
    }
  }
}

// The candidate whose averaged error is least becomes the colour in `signal`; of equal ones the first. All averages are
// over the same weights, so their sums decide.
kernel void sbf_select(global const float* restrict guides, global float* restrict signal,
                       global const float* restrict spatial, global const float* restrict results, int stride,
                       long plane, long origin, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf error[CANDIDATES];
    sum_errors(guides, signal, spatial, results, stride, plane, p, error);
    vf least = error[0], chosen[3];
#pragma unroll
    for (int c = 0; c < 3; ++c) chosen[c] = load(results + c * plane + p);
#pragma unroll
    for (int k = 1; k < CANDIDATES; ++k) {
      const vi better = error[k] < least;
      least = better ? error[k] : least;
#pragma unroll
      for (int c = 0; c < 3; ++c)
        chosen[c] = better ? load((k == BANK ? signal : results + 4 * k * plane) + c * plane + p) : chosen[c];
    }
#pragma unroll
    for (int c = 0; c < 3; ++c) store(chosen[c], signal + c * plane + p);
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict guides,
                   global const float* restrict signal, int stride, long plane, long origin, int x0, int y0, int x1,
                   int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(guides + p) < (vf)INFINITY;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, x1 - x, 0.0f);
      store_first(filtered_or_kept(valid, load(signal + c * plane + p), color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), x1 - x);
    }
  }
}
