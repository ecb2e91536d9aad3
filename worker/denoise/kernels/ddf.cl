// SPDX-License-Identifier: Apache-2.0
// The Data Driven Filter (van de Vlasakker 2013, section 6.2.3): a window over direct and indirect light, steered by
// features, each of which counts the less the more it varies within the pixel that is filtered.
//   strips: 0 depth (+infinity at invalid pixels), in tenths of the scene's diameter   1..3 normal   4..6 albedo
//   7..9 texture2   10..12 direct   13..15 indirect, both scaled so that a weight's exponent falls by the squared
//   differences   16..19 stops: by what the differences of the four features are to be multiplied for that
//   20 NEIGHBOURS: what every pixel but the centre counts in indirect light
//   20 or 21 PROGRESSIVE: by what the squared differences of light are to be multiplied

#define DIRECT 10
#define INDIRECT 13
#define STOPS 16
#define NEIGHBOURS 20
#ifdef IN_BOUNCE_VARIANCE
#define NOISE 21
#else
#define NOISE 20
#endif

// A stop is never 0: times the infinite distance of what is invalid it has to be infinite.
#define LEAST_STOP 1e-18f

// How much of a stop the variance of `channels` planes leaves.
vf left_by_variance(global const float* variance, size_t area, int channels, int x, int w, vf samples, float scale,
                    vi* valid) {
  vf sum = 0.0f;
  for (int c = 0; c < channels; ++c) {
    const vf v = load_within(variance + c * area, x, w, 0.0f);
    *valid &= ordinary(v);
    sum += v;
  }
  const vf spread = sum * samples * scale;
  return 1.0f - clamp(spread, (vf)0.0f, (vf)1.0f);
}

// units: scale of depth, direct light, indirect light; 1 / 8. stops: of depth, normal, albedo, texture2, the bounce's
// direction, for no variance. scales: of their variances.
kernel void prepare(WINDOW_INPUT, global float* restrict strips, WINDOW_REGION, float4 units, float8 stops,
                    float8 scales) {
  const int rows = y1 - y0 + 2 * RADIUS;
  const StripRow s = picture_row(get_global_id(1), x1 - x0);
  const int y = y0 - RADIUS + s.row;
  const size_t area = (size_t)w * h;
  const int planes[5] = {IN_N, IN_ALBEDO, IN_TEXTURE2, IN_DIRECT, IN_INDIRECT};
  const float scale[5] = {1, 1, 1, units.y, units.z};
  FOR_EACH_VECTOR(column, 0, PITCH) {
    const int x = x0 + s.strip * STRIP - PAD + column;
    global float* to = strips + strip_offset(s, rows) + column;
    if (y < 0 || y >= h || x <= -VW || x >= w) {
      store_outside(to, INFINITY);
      continue;
    }
    global const float* in = input + (size_t)y * w;
    const vf depth = load_within(in + IN_DEPTH * area, x, w, INFINITY);
    const vf samples = load_within(in + IN_SAMPLES * area, x, w, 1.0f);
    vi valid = ordinary(depth) & (depth < (vf)SKY) & ordinary(samples);
    vf value[PLANES];
    value[0] = depth * units.x;
    for (int k = 0; k < 5; ++k)
      for (int c = 0; c < 3; ++c) {
        const vf v = load_within(in + (planes[k] + c) * area, x, w, 0.0f);
        valid &= ordinary(v);
        value[1 + 3 * k + c] = v * scale[k];
      }
    for (int c = 0; c < 3; ++c) valid &= ordinary(load_within(in + (IN_EMISSION + c) * area, x, w, 0.0f));
#define LEFT(aov, channels, k) \
  left_by_variance(in + IN_##aov##_VARIANCE * area, area, channels, x, w, samples, scales.s##k, &valid)
    value[STOPS] = sqrt(LEFT(DEPTH, 1, 0)) * stops.s0;
    value[STOPS + 1] = sqrt(LEFT(N, 3, 1)) * stops.s1;
    value[STOPS + 2] = sqrt(LEFT(ALBEDO, 3, 2)) * stops.s2;
    value[STOPS + 3] = sqrt(LEFT(TEXTURE2, 3, 3)) * stops.s3;
    value[STOPS] = max(value[STOPS], (vf)LEAST_STOP);
#ifdef IN_BOUNCE_VARIANCE
    value[NEIGHBOURS] = exp2_of_negative(LEFT(BOUNCE, 3, 4) * -stops.s4);
#endif
#ifdef PROGRESSIVE
    value[NOISE] = max(samples, (vf)1.0f) * units.w;
#endif
    for (int c = 0; c < PLANES; ++c) put(valid ? value[c] : (vf)(c == 0 ? INFINITY : 0.0f), to + c * PITCH);
  }
}

// One kind of light: weights, and weighted differences from the centre.
typedef struct {
  vf sum, red, green, blue;
} Light;

#define TAPS (2 * RADIUS / STEP + 1)

// Adds a row of taps, the first at q, of the light that begins at that plane. exponents: of the weights, less what the
// light's own difference takes off. p: the centre.
INLINE void gather_light(Light* light, global const float* p, global const float* q, const vf* exponents, vf noise) {
  const vf r = fetch(p), g = fetch(p + PITCH), b = fetch(p + 2 * PITCH);
  Light sums = *light;
#pragma nounroll
  for (int k = 0; k < TAPS; ++k, q += STEP) {
    const vf dr = fetch(q) - r, dg = fetch(q + PITCH) - g, db = fetch(q + 2 * PITCH) - b;
    vf exponent = exponents[k];
#ifdef PROGRESSIVE
    exponent = fma(-noise, fma(dr, dr, fma(dg, dg, db * db)), exponent);
#else
    exponent = fma(-dr, dr, exponent);
    exponent = fma(-dg, dg, exponent);
    exponent = fma(-db, db, exponent);
#endif
    const vf weight = weight_of(exponent);
    sums.sum += weight;
    sums.red = fma(weight, dr, sums.red);
    sums.green = fma(weight, dg, sums.green);
    sums.blue = fma(weight, db, sums.blue);
  }
  *light = sums;
}

// The exponent less the squared difference of one plane; stop, stopped: what the difference is multiplied by, and
// minus the centre times that.
#define STOPPED(exponent, c, stop, stopped)                 \
  {                                                         \
    const vf d = fma(stop, fetch(q + (c) * PITCH), stopped); \
    exponent = fma(-d, d, exponent);                        \
  }

// What the features of a row of taps, the first at q, leave of the exponents of direct and of indirect light. Features
// and lights have a loop each, for together they take more registers than there are.
INLINE void stop_by_features(global const float* p, global const float* q, vf* of_direct, vf* of_indirect) {
  vf stop[4], stopped[10];
#pragma unroll
  for (int f = 0; f < 4; ++f) stop[f] = fetch(p + (STOPS + f) * PITCH);
  stopped[0] = -fetch(p) * stop[0];
#pragma unroll
  for (int c = 1; c < 10; ++c) stopped[c] = -fetch(p + c * PITCH) * stop[(c + 2) / 3];
#pragma nounroll
  for (int k = 0; k < TAPS; ++k, q += STEP) {
    vf exponent = OF_ONE;
    STOPPED(exponent, 0, stop[0], stopped[0])
    STOPPED(exponent, 1, stop[1], stopped[1])
    STOPPED(exponent, 2, stop[1], stopped[2])
    STOPPED(exponent, 3, stop[1], stopped[3])
    STOPPED(exponent, 4, stop[2], stopped[4])
    STOPPED(exponent, 5, stop[2], stopped[5])
    STOPPED(exponent, 6, stop[2], stopped[6])
    of_direct[k] = exponent;
    STOPPED(exponent, 7, stop[3], stopped[7])
    STOPPED(exponent, 8, stop[3], stopped[8])
    STOPPED(exponent, 9, stop[3], stopped[9])
    of_indirect[k] = exponent;
  }
}

// What a vector of pixels has gathered.
typedef struct {
  Light direct, indirect;
} Lights;

// Adds the row of the window about p of which the first tap is at q.
INLINE void gather_row(Lights* lights, global const float* p, global const float* q) {
  vf noise = 1.0f, of_direct[TAPS], of_indirect[TAPS];
#ifdef PROGRESSIVE
  noise = fetch(p + NOISE * PITCH);
#endif
  stop_by_features(p, q, of_direct, of_indirect);
  gather_light(&lights->direct, p + DIRECT * PITCH, q + DIRECT * PITCH, of_direct, noise);
  gather_light(&lights->indirect, p + INDIRECT * PITCH, q + INDIRECT * PITCH, of_indirect, noise);
}

// output: RGB over [x0, x1) x [y0, y1). Invalid pixels keep their light. unscale: 1 over the scales of direct and
// indirect light.
kernel void ddf(WINDOW_INPUT, global const float* restrict strips, WINDOW_REGION, float2 unscale,
                global float* restrict output) {
  const WindowRow r = window_row(x0, y0, x1, y1);
  global const float* centres = strips + r.strip;
  global float* out = output + r.out;
  const size_t area = (size_t)w * h;
  for (int begin = get_global_id(0) * VW; begin < r.columns; begin += get_global_size(0) * VW * SIDE) {
    Lights all[SIDE];
    const Light none = {0.0f, 0.0f, 0.0f, 0.0f};
    for (int v = 0; v < SIDE; ++v) all[v].direct = all[v].indirect = none;
#pragma nounroll
    for (int j = -RADIUS; j <= RADIUS; j += STEP)
#pragma nounroll
      for (int v = 0; v < SIDE && begin + v * VW < r.columns; ++v) {
        global const float* p = centres + begin + v * VW;
        gather_row(&all[v], p, p + j * (PLANES * PITCH) - RADIUS);
      }
#pragma nounroll
    for (int v = 0; v < SIDE && begin + v * VW < r.columns; ++v) {
      const int column = begin + v * VW;
      global const float* p = centres + column;
      const Light direct = all[v].direct;
      Light indirect = all[v].indirect;
#ifdef IN_BOUNCE_VARIANCE
      // The centre's weight is 1.
      const vf kept = fetch(p + NEIGHBOURS * PITCH);
      indirect.sum = fma(kept, indirect.sum - 1.0f, (vf)1.0f);
      indirect.red *= kept;
      indirect.green *= kept;
      indirect.blue *= kept;
#endif
      // The pixel plus the mean difference, not the mean: a constant picture comes back bit for bit.
      const vf per_direct = unscale.x / direct.sum, per_indirect = unscale.y / indirect.sum;
      const vf d[3] = {direct.red, direct.green, direct.blue}, e[3] = {indirect.red, indirect.green, indirect.blue};
      const vi valid = fetch(p) < (vf)INFINITY;
      global const float* in = input + (size_t)r.y * w + x0 + r.first + column;
      const int n = r.columns - column;
      for (int c = 0; c < 3; ++c) {
        const vf a = load_first(in + (IN_DIRECT + c) * area, n, 0.0f), b = load_first(in + (IN_INDIRECT + c) * area, n, 0.0f);
        const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
        const vf filtered = fma(d[c], per_direct, a) + fma(e[c], per_indirect, b) + emission;
        store_first(filtered_or_kept(valid, filtered, a + b + emission), out + c * r.area + column, n);
      }
    }
  }
}
