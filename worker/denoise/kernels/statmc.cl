// SPDX-License-Identifier: Apache-2.0
// The statistical denoiser of Sakai et al. 2024: a joint bilateral filter by albedo and normal that takes only pixels
// whose means no test tells apart.
//   strips: 0..2 albedo (0 is +infinity at invalid pixels)   3..5 unit normal, both such that squared differences are
//   what their Gaussians take off a weight's exponent   6..8 means of the transformed samples, corrected for skewness
//   9..11 squared half-widths of their intervals   12..14 colour
// TABLE, T_SQUARED: squared quantiles of Student's t by samples, 0 to TABLE. T0..T4: for more.

#define MIDDLE 6
#define WIDTH 9
#define COLOR 12

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

kernel void prepare(WINDOW_INPUT, global float* restrict strips, WINDOW_REGION, float albedo_scale,
                    float normal_scale) {
  const int rows = y1 - y0 + 2 * RADIUS;
  const StripRow s = picture_row(get_global_id(1), x1 - x0);
  const int y = y0 - RADIUS + s.row;
  const size_t area = (size_t)w * h;
  FOR_EACH_VECTOR(column, 0, PITCH) {
    const int x = x0 + s.strip * STRIP - PAD + column;
    global float* to = strips + strip_offset(s, rows) + column;
    if (y < 0 || y >= h || x <= -VW || x >= w) {
      store_outside(to, INFINITY);
      continue;
    }
    global const float* in = input + (size_t)y * w;
    const vf depth = load_within(in + IN_DEPTH * area, x, w, INFINITY);
    const vf samples = load_within(in + IN_SAMPLES * area, x, w, 0.0f);
    vi valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(samples) & (samples >= (vf)0.0f);
    const vf t = t_squared_of(valid ? samples : (vf)0.0f);
    vf value[PLANES], norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_within(in + (IN_COLOR + c) * area, x, w, 0.0f);
      const vf albedo = load_within(in + (IN_ALBEDO + c) * area, x, w, 0.0f);
      const vf normal = load_within(in + (IN_N + c) * area, x, w, 0.0f);
      const vf transformed = load_within(in + (IN_BOXCOX + c) * area, x, w, 0.0f);
      const vf variance = load_within(in + (IN_BOXCOX_VARIANCE + c) * area, x, w, 0.0f);
      const vf third = load_within(in + (IN_BOXCOX_THIRD + c) * area, x, w, 0.0f);
      valid &= ordinary(color) & ordinary(albedo) & ordinary(normal) & ordinary(transformed) & ordinary(variance) &
               (variance >= (vf)0.0f) & ordinary(third);
      const Interval mean = interval(transformed, variance, third, samples, t);
      value[c] = albedo * albedo_scale;
      value[3 + c] = normal;
      value[MIDDLE + c] = mean.middle;
      value[WIDTH + c] = mean.squared_half_width;
      value[COLOR + c] = color;
      norm = fma(normal, normal, norm);
    }
    const vf scale = norm > (vf)1e-12f ? normal_scale / sqrt(norm) : (vf)0.0f;
    for (int c = 0; c < 3; ++c) value[3 + c] *= scale;
    for (int c = 0; c < PLANES; ++c) put(valid ? value[c] : (vf)(c == 0 ? INFINITY : 0.0f), to + c * PITCH);
  }
}

// Half the width of the disc's row j.
int half_width(int j) {
  int i = 0;
  while ((i + 1) * (i + 1) + j * j <= RADIUS * RADIUS) ++i;
  return i;
}

// Of a vector of pixels: weights, and weighted differences of colour from the centre.
typedef struct {
  vf sum, red, green, blue;
} Gathered;

// Adds a row of the disc about p, 2 reach + 1 taps about q. far: the exponent of a weight as far away as that row.
INLINE void gather_row(Gathered* sums, global const float* p, global const float* q, int reach, float far, float k) {
  vf guide[6], middle[3], width[3], color[3];
  for (int c = 0; c < 6; ++c) guide[c] = fetch(p + c * PITCH);
  for (int c = 0; c < 3; ++c) {
    middle[c] = fetch(p + (MIDDLE + c) * PITCH);
    width[c] = fetch(p + (WIDTH + c) * PITCH);
    color[c] = fetch(p + (COLOR + c) * PITCH);
  }
  Gathered all = *sums;
  q -= reach;
#pragma nounroll
  for (int i = -reach; i <= reach; ++i, ++q) {
    // (m_p - m_q)^2 <= t_p^2 V_p + t_q^2 V_q, channel by channel.
    vi same = (vi)-1;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      const vf d = fetch(q + (MIDDLE + c) * PITCH) - middle[c];
      same &= fma(d, d, -fetch(q + (WIDTH + c) * PITCH)) <= width[c];
    }
    vf exponent = far - k * (float)(i * i);
#pragma unroll
    for (int c = 0; c < 6; ++c) {
      const vf d = fetch(q + c * PITCH) - guide[c];
      exponent = fma(-d, d, exponent);
    }
    exponent = exponent > (vf)0.0f ? exponent : (vf)0.0f;
    const vf weight = number_of(same ? exponent : (vf)0.0f);
    all.sum += weight;
    all.red = fma(weight, fetch(q + COLOR * PITCH) - color[0], all.red);
    all.green = fma(weight, fetch(q + (COLOR + 1) * PITCH) - color[1], all.green);
    all.blue = fma(weight, fetch(q + (COLOR + 2) * PITCH) - color[2], all.blue);
  }
  *sums = all;
}

// k: what a distance of one pixel takes off a weight's exponent. output: RGB over [x0, x1) x [y0, y1).
kernel void statmc_gather(WINDOW_INPUT, global const float* restrict strips, WINDOW_REGION, float k,
                          global float* restrict output) {
  const WindowRow r = window_row(x0, y0, x1, y1);
  global const float* centres = strips + r.strip;
  global float* out = output + r.out;
  const size_t area = (size_t)w * h;
  for (int begin = get_global_id(0) * VW; begin < r.columns; begin += get_global_size(0) * VW * SIDE) {
    Gathered all[SIDE];
    const Gathered none = {0.0f, 0.0f, 0.0f, 0.0f};
    for (int v = 0; v < SIDE; ++v) all[v] = none;
#pragma nounroll
    for (int j = -RADIUS; j <= RADIUS; ++j)
#pragma nounroll
      for (int v = 0; v < SIDE && begin + v * VW < r.columns; ++v) {
        global const float* p = centres + begin + v * VW;
        gather_row(&all[v], p, p + j * (PLANES * PITCH), half_width(j), OF_ONE - k * (float)(j * j), k);
      }
#pragma nounroll
    for (int v = 0; v < SIDE && begin + v * VW < r.columns; ++v) {
      const int column = begin + v * VW, n = r.columns - column;
      global const float* p = centres + column;
      // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
      const vf scale = 1.0f / all[v].sum;
      const vi valid = fetch(p) < (vf)INFINITY;
      const vf total[3] = {all[v].red, all[v].green, all[v].blue};
      for (int c = 0; c < 3; ++c) {
        const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)r.y * w + x0 + r.first + column, n, 0.0f);
        const vf filtered = fma(total[c], scale, fetch(p + (COLOR + c) * PITCH));
        store_first(filtered_or_kept(valid, filtered, color), out + c * r.area + column, n);
      }
    }
  }
}
