// SPDX-License-Identifier: Apache-2.0
// The statistical denoiser of Sakai et al. 2024: a joint bilateral filter by albedo and normal that takes only pixels
// whose means no test tells apart.
//   guides: 0..2 albedo (0 is +infinity at invalid pixels)   3..5 unit normal, both such that
//   squared differences are what their Gaussians take off a weight's exponent
//   tests: 0..2 means of the transformed samples, corrected for skewness   3..5 squared half-widths of their intervals
//   colors: RGB
// RADIUS: of the disc. TABLE, T_SQUARED: squared quantiles of Student's t by samples, 0 to TABLE. T0..T4: for more.

#define BOUNDLESS 1e38f  // of an interval: one sample says nothing about its spread

constant float kTSquared[TABLE + 1] = {T_SQUARED};

// Squared quantile of Student's t with 2 samples - 2 degrees of freedom.
float t_squared(float samples) {
  if (samples <= TABLE) return kTSquared[(int)samples];
  const float u = 1.0f / (2.0f * samples - 2.0f);
  const float t = fma(u, fma(u, fma(u, fma(u, T4, T3), T2), T1), T0);
  return t * t;
}

vf t_squared_of(vf samples) {
  float lanes[VW];
  store(samples, lanes);
  for (int k = 0; k < VW; ++k) lanes[k] = t_squared(lanes[k]);
  return load(lanes);
}

// The mean's interval at the level asked for, of Johnson 1978: its middle is the mean plus m3 / (6 s^2 n), which takes
// out what the samples' skewness makes of it.
typedef struct {
  vf middle, squared_half_width;
} Interval;

Interval interval(vf mean, vf variance_of_mean, vf third_moment, vf samples, vf t_squared) {
  Interval i;
  const vf correction = third_moment / (6.0f * variance_of_mean * samples * samples);
  i.middle = mean + (fabs(correction) <= (vf)LARGEST ? correction : (vf)0.0f);
  i.squared_half_width = samples >= (vf)2.0f ? t_squared * variance_of_mean : (vf)BOUNDLESS;
  return i;
}

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict tests, global float* restrict colors, int stride, long plane, long origin,
                    float albedo_scale, float normal_scale) {
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
    const vf t = t_squared_of(valid ? samples : (vf)0.0f);
    vf color[3], albedo[3], normal[3], norm = 0.0f;
    Interval mean[3];
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      albedo[c] = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      const vf transformed = load_first(in + (IN_BOXCOX + c) * area, n, 0.0f);
      const vf variance = load_first(in + (IN_BOXCOX_VARIANCE + c) * area, n, 0.0f);
      const vf third = load_first(in + (IN_BOXCOX_THIRD + c) * area, n, 0.0f);
      valid &= ordinary(color[c]) & ordinary(albedo[c]) & ordinary(normal[c]) & ordinary(transformed) &
               ordinary(variance) & (variance >= (vf)0.0f) & ordinary(third);
      mean[c] = interval(transformed, variance, third, samples, t);
      norm = fma(normal[c], normal[c], norm);
    }
    const vf scale = norm > (vf)1e-12f ? normal_scale / sqrt(norm) : (vf)0.0f;
    for (int c = 0; c < 3; ++c) {
      store(valid ? albedo[c] * albedo_scale : (vf)(c == 0 ? INFINITY : 0.0f), guides + c * plane + p);
      store(valid ? normal[c] * scale : (vf)0.0f, guides + (3 + c) * plane + p);
      store(valid ? mean[c].middle : (vf)0.0f, tests + c * plane + p);
      store(valid ? mean[c].squared_half_width : (vf)0.0f, tests + (3 + c) * plane + p);
      store(valid ? color[c] : (vf)0.0f, colors + c * plane + p);
    }
  }
}

// Half the width of the disc's row j.
int half_width(int j) {
  int i = 0;
  while ((i + 1) * (i + 1) + j * j <= RADIUS * RADIUS) ++i;
  return i;
}

// k: what a distance of one pixel takes off a weight's exponent. output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region.
kernel void statmc_gather(global const float* restrict input, int w, int h, global const float* restrict guides,
                          global const float* restrict tests, global const float* restrict colors, int stride,
                          long plane, long origin, int x0, int y0, int x1, int y1, float k,
                          global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf guide[6], middle[3], width[3], color[3], total[3], sum = 1.0f;
    for (int c = 0; c < 6; ++c) guide[c] = load(guides + c * plane + p);
    for (int c = 0; c < 3; ++c) {
      middle[c] = load(tests + c * plane + p);
      width[c] = load(tests + (3 + c) * plane + p);
      color[c] = load(colors + c * plane + p);
      total[c] = 0.0f;
    }
#pragma nounroll
    for (int j = -RADIUS; j <= RADIUS; ++j) {
      const int reach = half_width(j);
#pragma nounroll
      for (int i = -reach; i <= reach; ++i) {
        if (i == 0 && j == 0) continue;
        const size_t q = p + (long)j * stride + i;
        // (m_p - m_q)^2 <= t_p^2 V_p + t_q^2 V_q, channel by channel.
        vi same = (vi)-1;
#pragma unroll
        for (int c = 0; c < 3; ++c) {
          const vf d = load(tests + c * plane + q) - middle[c];
          same &= fma(d, d, -load(tests + (3 + c) * plane + q)) <= width[c];
        }
        vf exponent = OF_ONE - k * (float)(i * i + j * j);
#pragma unroll
        for (int c = 0; c < 6; ++c) {
          const vf d = load(guides + c * plane + q) - guide[c];
          exponent = fma(-d, d, exponent);
        }
        exponent = exponent > (vf)0.0f ? exponent : (vf)0.0f;
        const vf weight = number_of(same ? exponent : (vf)0.0f);
        sum += weight;
#pragma unroll
        for (int c = 0; c < 3; ++c) total[c] = fma(weight, load(colors + c * plane + q) - color[c], total[c]);
      }
    }
    // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
    const vf scale = 1.0f / sum;
    const vi valid = guide[0] < (vf)INFINITY;
    const int n = x1 - x;
    for (int c = 0; c < 3; ++c) {
      const vf raw = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, n, 0.0f);
      const vf kept = fabs(raw) < (vf)INFINITY ? raw : (vf)0.0f;
      store_first(valid ? fma(total[c], scale, color[c]) : kept,
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
