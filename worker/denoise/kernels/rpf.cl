// SPDX-License-Identifier: Apache-2.0
// Random Parameter Filtering (Sen and Darabi 2012, as read by van de Vlasakker 2013): each sample of a pixel becomes a
// weighted mean of its neighbours, and what depends on the renderer's random numbers weighs little in their
// differences.
//   samples: SLOTS lines a pixel   counts: how many of them are samples   to: their colours after an iteration
#define VECTOR_NUMBERS 26  // of an input sample; their order is that of SampleVector
#define SCREEN_IN 0
#define RANDOM_IN 2
#define FEATURES_IN 8
#define COLOR_IN 23
#define NORMAL2 9      // features
#define ALBEDO 12
#define SECOND_HIT 15
#define TERMS (16 + 3)  // features, colours

// A sample as a line; false if it is none: a sample that was dropped, or never taken, is all zeros.
bool put_line(global const float* restrict in, size_t area, float brightest, int flagged, global float* restrict line) {
  float v[VECTOR_NUMBERS];
  bool finite = true, any = false;
  for (int k = 0; k < VECTOR_NUMBERS; ++k) {
    v[k] = in[k * area];
    finite &= fabs(v[k]) <= LARGEST;
    any |= v[k] != 0.0f;
  }
  if (!finite || !any) return false;
  for (int k = 0; k < 15; ++k) line[k] = v[FEATURES_IN + k];
  const bool second = line[NORMAL2] != 0.0f || line[NORMAL2 + 1] != 0.0f || line[NORMAL2 + 2] != 0.0f;
  line[SECOND_HIT] = flagged && second ? 1.0f : 0.0f;
  for (int k = 0; k < 6; ++k) line[RANDOM + k] = v[RANDOM_IN + k];
  for (int k = 0; k < 2; ++k) line[SCREEN + k] = v[SCREEN_IN + k];
  for (int k = 0; k < 3; ++k) line[COLOR + k] = line[CURRENT + k] = min(v[COLOR_IN + k], brightest);
  line[30] = line[31] = 0.0f;
  return true;
}

// Of a film's half, halves A and B are the same samples: they count once.
bool halves_are_one(global const float* restrict in, size_t area) {
  for (int s = 0; s < SLOTS / 2; ++s)
    for (int k = SCREEN_IN; k < SCREEN_IN + 2; ++k)
      if (in[(IN_SAMPLESRPF_A + s * VECTOR_NUMBERS + k) * area] != in[(IN_SAMPLESRPF_B + s * VECTOR_NUMBERS + k) * area])
        return false;
  return true;
}

kernel void rpf_prepare(global const float* restrict input, int w, int h, float brightest, int flagged,
                        global float* restrict samples, global int* restrict counts) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  for (int x = get_global_id(0); x < w; x += get_global_size(0)) {
    const size_t p = (size_t)y * w + x;
    global const float* in = input + p;
    global float* lines = samples + p * SLOTS * LINE;
    bool valid = fabs(in[IN_DEPTH * area]) < SKY;
    for (int c = 0; c < 3; ++c) valid &= fabs(in[(IN_COLOR + c) * area]) <= LARGEST;
    const int slots = valid ? halves_are_one(in, area) ? SLOTS / 2 : SLOTS : 0;
    int count = 0;
    for (int s = 0; s < slots; ++s) {
      const size_t first = s < SLOTS / 2 ? IN_SAMPLESRPF_A + s * VECTOR_NUMBERS
                                         : IN_SAMPLESRPF_B + (s - SLOTS / 2) * VECTOR_NUMBERS;
      count += put_line(in + first * area, area, brightest, flagged, lines + count * LINE);
    }
    for (int k = count * LINE; k < SLOTS * LINE; ++k) lines[k] = INFINITY;
    counts[p] = count;
  }
}

// What differs between iterations and presets.
typedef struct {
  float dependence;                    // (1 + 0.1 t)
  float color, texture, normal;        // factors of alpha, and of beta of some features
  float variance;                      // 8 sigma_8^2
} Weighting;

#define EPSILON 1e-5f

// alpha and beta of van de Vlasakker 2013, equations 5.4 to 5.15, with the three totals of equation 5.11 as
// denominator of 5.12: its own names another index. Times log2(e) (1 - W_c^r)^2 / (2 sigma^2), divided by the
// deviations, and rooted: what differences are to be scaled by.
void weigh(const Histograms* restrict h, const Neighbours* restrict n, int own, Weighting p, global const uint* restrict table,
           float* restrict scale) {
  float random[TERMS], screen[TERMS], colors[16], of_colors[3] = {0, 0, 0};
  float total = EPSILON, contribution = 0.0f;
  for (int row = 0; row < TERMS; ++row) {
    float m[COLUMNS];
    information(h, n->count, row, table, m);
    random[row] = m[0] + m[1] + m[2] + m[3] + m[4] + m[5];
    screen[row] = m[6] + m[7];
    if (row < 16) {
      colors[row] = m[8] + m[9] + m[10];
      total += colors[row];
    } else {
      total += random[row] + screen[row];
    }
  }
  float deviations[32];
  for (int row = 0; row < TERMS; ++row) {
    const float fraction = random[row] / (random[row] + screen[row] + EPSILON);
    const float independent = max(0.0f, 1.0f - p.dependence * fraction);
    if (row < 16) {
      scale[row] = colors[row] / total * independent;
      if (row >= ALBEDO && row < SECOND_HIT) scale[row] *= p.texture;
      if ((row >= 3 && row < 6) || (row >= NORMAL2 && row < ALBEDO)) scale[row] *= p.normal;
    } else {
      scale[row] = p.color * independent;
      contribution += fraction;
    }
  }
  const float rest = 1.0f - contribution / 3.0f;
  const float sharpness = LOG2_E * rest * rest * (float)own / (2.0f * p.variance);
  vstore16(n->inverse_deviation[0], 0, deviations);
  vstore16(n->inverse_deviation[1], 1, deviations);
  for (int row = 0; row < TERMS; ++row)
    scale[row] = sqrt(scale[row] * sharpness) * deviations[row < 16 ? row : CURRENT + row - 16];
}

// 2^t for t <= 0, as exp2_of_negative.
float8 exp2_of_negative8(float8 t) {
  const float8 lowest = -127.0f, to_integer = 12582912.0f;
  t = t > lowest ? t : lowest;
  const float8 shifted = t + to_integer;
  const float8 f = t - (shifted - to_integer);
  float8 e = 1.33813021e-3f;
  e = fma(e, f, (float8)9.66636837e-3f);
  e = fma(e, f, (float8)5.55038117e-2f);
  e = fma(e, f, (float8)2.40223497e-1f);
  e = fma(e, f, (float8)6.93147182e-1f);
  e = fma(e, f, (float8)1.0f);
  return e * as_float8((as_int8(shifted) + 127) << 23);
}

// The terms whose differences count, and the pixel's samples, scaled: one in each lane.
typedef struct {
  int terms;
  int number[TERMS];  // of the line
  float8 scale[TERMS], own[TERMS];
  float8 color[3];
} Center;

void set_center(Center* restrict c, global const float* restrict own, int count, const float* restrict scale) {
  c->terms = 0;
  float lanes[8];
  for (int row = 0; row < TERMS; ++row) {
    if (!(scale[row] > 0.0f)) continue;
    const int number = row < 16 ? row : CURRENT + row - 16;
    for (int s = 0; s < 8; ++s) lanes[s] = own[min(s, count - 1) * LINE + number];
    c->number[c->terms] = number;
    c->scale[c->terms] = -scale[row];
    c->own[c->terms] = vload8(0, lanes) * scale[row];
    ++c->terms;
  }
  for (int k = 0; k < 3; ++k) {
    for (int s = 0; s < 8; ++s) lanes[s] = own[min(s, count - 1) * LINE + CURRENT + k];
    c->color[k] = vload8(0, lanes);
  }
}

#define TOGETHER 8  // neighbours

// Colours of the pixel's samples after this iteration (equation 5.18): their own and the weighted mean difference, so
// that equal colours stay what they are.
void blend(const Center* restrict c, const Neighbours* restrict n, global const float* restrict samples,
           float8* restrict result) {
  float8 sum = 0, r = 0, g = 0, b = 0;
  for (int first = 0; first < n->count; first += TOGETHER) {
    global const float* line[TOGETHER];
    float8 distance[TOGETHER];
#pragma unroll
    for (int j = 0; j < TOGETHER; ++j) {
      line[j] = samples + (size_t)n->at[min(first + j, n->count - 1)] * LINE;
      distance[j] = 0;
    }
#pragma nounroll
    for (int k = 0; k < c->terms; ++k) {
      const float8 scale = c->scale[k], own = c->own[k];
      const int number = c->number[k];
#pragma unroll
      for (int j = 0; j < TOGETHER; ++j) {
        const float8 d = fma((float8)line[j][number], scale, own);
        distance[j] = fma(d, d, distance[j]);
      }
    }
#pragma unroll
    for (int j = 0; j < TOGETHER; ++j) {
      const float8 weight = first + j < n->count ? exp2_of_negative8(-distance[j]) : (float8)0.0f;
      sum += weight;
      r = fma(weight, line[j][CURRENT] - c->color[0], r);
      g = fma(weight, line[j][CURRENT + 1] - c->color[1], g);
      b = fma(weight, line[j][CURRENT + 2] - c->color[2], b);
    }
  }
  const float8 d[3] = {r, g, b};
  for (int k = 0; k < 3; ++k) result[k] = c->color[k] + (sum > 0.0f ? d[k] / sum : (float8)0.0f);
}

// Mean of the first `count`: the first, and the mean difference from it.
float mean_of(const float* v, int count) {
  float sum = 0.0f;
  for (int s = 1; s < count; ++s) sum += v[s] - v[0];
  return v[0] + sum / (float)count;
}

// Samples that are farther than a deviation from their pixel's mean take the mean, then all take what light that cost.
void remove_spikes(float color[3][8], int count) {
  float mean[3], deviation[3];
  for (int k = 0; k < 3; ++k) {
    float square = 0.0f;
    mean[k] = mean_of(color[k], count);
    for (int s = 0; s < count; ++s) square = fma(color[k][s] - mean[k], color[k][s] - mean[k], square);
    deviation[k] = sqrt(square / (float)count);
  }
  for (int s = 0; s < count; ++s) {
    bool spike = false;
    for (int k = 0; k < 3; ++k) spike |= fabs(color[k][s] - mean[k]) > deviation[k];
    for (int k = 0; k < 3; ++k) color[k][s] = spike ? mean[k] : color[k][s];
  }
  for (int k = 0; k < 3; ++k) {
    const float lost = mean[k] - mean_of(color[k], count);
    for (int s = 0; s < count; ++s) color[k][s] += lost;
  }
}

// rejection: deviations that a feature, and that a position, may be away from the pixel's mean; the distances that
// neither of them counts.
kernel void rpf_filter(global const float* restrict samples, global const int* restrict counts,
                       global float* restrict to, int x0, int y0, int x1, int y1, int4 where, int iteration, int radius,
                       float draws, uint seed, float4 rejection, int buckets, float4 factors, float variance, int spikes,
                       global const uchar* restrict offsets, global const uint* restrict table) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  const Box box = {where.x, where.y, where.z, where.w, iteration, radius, draws, seed};
  const Weighting weighting = {factors.x, factors.y, factors.z, factors.w, variance};
  const float t = rejection.x, p = rejection.y, a = rejection.z, b = rejection.w;
  const float16 deviations = (float16)(p, p, p, t, t, t, p, p, p, t, t, t, t, t, t, t);
  const float16 guard = (float16)(b, b, b, a, a, a, b, b, b, a, a, a, a, a, a, a);
  Neighbours near;
  Histograms histograms;
  for (int x = x0 + (int)get_global_id(0); x < x1; x += get_global_size(0)) {
    const size_t pixel = (size_t)y * box.w + x;
    const int own = counts[pixel];
    if (own == 0) continue;
    find(&near, samples, box, x, y, own, deviations, guard, offsets + 4096 * iteration);
    set_up(&histograms, &near, buckets);
    count_pairs(&histograms, &near, samples);
    float scale[TERMS];
    weigh(&histograms, &near, own, weighting, table, scale);
    Center center;
    set_center(&center, samples + pixel * SLOTS * LINE, own, scale);
    float8 result[3];
    blend(&center, &near, samples, result);
    float color[3][8];
    for (int k = 0; k < 3; ++k) vstore8(result[k], 0, color[k]);
    if (spikes) remove_spikes(color, own);
    for (int s = 0; s < own; ++s)
      for (int k = 0; k < 3; ++k) to[(pixel * SLOTS + s) * 3 + k] = color[k][s];
  }
}

// All pixels' new colours take the place of the old ones.
kernel void rpf_commit(global float* restrict samples, global const int* restrict counts,
                       global const float* restrict to, int w, int x0, int y0, int x1, int y1) {
  const int y = y0 + get_global_id(1);
  if (y >= y1) return;
  for (int x = x0 + (int)get_global_id(0); x < x1; x += get_global_size(0)) {
    const size_t pixel = (size_t)y * w + x;
    for (int s = 0; s < counts[pixel]; ++s)
      for (int k = 0; k < 3; ++k)
        samples[(pixel * SLOTS + s) * LINE + CURRENT + k] = to[(pixel * SLOTS + s) * 3 + k];
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Pixels without samples keep their colour.
kernel void rpf_finish(global const float* restrict input, int w, int h, global const float* restrict samples,
                       global const int* restrict counts, int x0, int y0, int x1, int y1,
                       global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  for (int x = x0 + (int)get_global_id(0); x < x1; x += get_global_size(0)) {
    const size_t pixel = (size_t)y * w + x;
    for (int k = 0; k < 3; ++k) {
      const float color = input[(IN_COLOR + k) * area + pixel];
      float v[SLOTS];
      for (int s = 0; s < counts[pixel]; ++s) v[s] = samples[(pixel * SLOTS + s) * LINE + CURRENT + k];
      const float kept = fabs(color) < INFINITY ? color : 0.0f;
      output[k * out_area + (size_t)row * (x1 - x0) + (x - x0)] = counts[pixel] > 0 ? mean_of(v, counts[pixel]) : kept;
    }
  }
}
