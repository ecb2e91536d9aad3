// SPDX-License-Identifier: Apache-2.0
// Which samples Random Parameter Filtering (Sen and Darabi 2012) compares a pixel's samples with: drawn at random about
// it, kept where their features are like the pixel's.
//
// Vectors do not hold neighbouring pixels here, but the numbers of one sample (16 at a time) or one number of a pixel's
// eight samples: every pixel has neighbours of its own.
//
// A sample is a line of LINE numbers, a pixel is SLOTS lines, those that hold a sample in front; the others are infinite,
// so that they are like nothing.
//   0..14 features: position, normal of the first hit, of the second, albedo   15 whether there is a second hit
//   16..21 lens, time, direction of the first bounce   22, 23 screen   24..26 colour   27..29 colour after the last
//   iteration   30, 31 zero
#define LINE 32
#define SLOTS 8
#define SCREEN 22
#define COLOR 24
#define CURRENT 27
#define MOST_SAMPLES 16384  // of a neighbourhood: 63 * 63 * 8 / 2 and some
#define BOX_STRIDE 64       // of the table of drawn samples, a byte for a pixel

// A pixel's neighbourhood: which samples, and how their numbers are distributed.
typedef struct {
  int count;
  uint at[MOST_SAMPLES];  // 8 * pixel + slot: first the pixel's own
  float16 mean[2], inverse_deviation[2];  // of all numbers of the lines; 0 where they do not differ
  float16 low[2], high[2];
} Neighbours;

#define MIX(x)       \
  x ^= x >> 16;      \
  x *= 0x85ebca6bu;  \
  x ^= x >> 13;      \
  x *= 0xc2b2ae35u;  \
  x ^= x >> 16;

uint mixed(uint x) {
  MIX(x)
  return x;
}

// Every draw is a number of its own: of the frame, the iteration, the pixel in the frame's grid, and the draw.
uint key_of(uint seed, int iteration, int x, int y) {
  return mixed(mixed(mixed(mixed(seed) + (uint)iteration) + (uint)x) + (uint)y);
}

// Marks what is drawn. `offsets`: 4096 equally likely distances from the box's edge, Gaussian about its middle.
void draw(uint key, int draws, int slots, global const uchar* restrict offsets, uchar* restrict drawn) {
  const uint16 lane = (uint16)(0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15);
  uint random[16], slot[16];
  for (int d = 0; d < draws; d += 16) {
    const uint16 number = lane + (uint)d;
    uint16 h = key + number * 0x9e3779b9u;
    MIX(h)
    const uint16 bit = (uint16)1 << (((h >> 24) * (uint)slots) >> 8);
    vstore16(h, 0, random);
    vstore16(convert_int16(number) < draws ? bit : (uint16)0, 0, slot);
    for (int k = 0; k < 16; ++k)
      drawn[offsets[random[k] & 4095] + BOX_STRIDE * offsets[random[k] >> 12 & 4095]] |= slot[k];
  }
}

int bits_of_lanes(int16 v) {
  const int8 a = v.lo | v.hi;
  const int4 b = a.lo | a.hi;
  const int2 c = b.lo | b.hi;
  return c.x | c.y;
}

// Which of a pixel's slots hold a sample whose features are all within [low, high].
uint alike(global const float* restrict pixel, float16 low, float16 high) {
  int16 outside = 0;
#pragma unroll
  for (int s = 0; s < SLOTS; ++s) {
    const float16 v = vload16(0, pixel + s * LINE);
    outside |= ((v < low) | (v > high)) & (1 << s);
  }
  return ~bits_of_lanes(outside) & 255;
}

// Means and deviations over the samples of a list, the sums taken in its order as distances from `about`.
void measure(Neighbours* restrict n, global const float* restrict samples, const float16* about) {
  const float16 a0 = about[0], a1 = about[1];
  float16 sum0 = 0, sum1 = 0, square0 = 0, square1 = 0, low0 = INFINITY, low1 = INFINITY, high0 = -INFINITY,
          high1 = -INFINITY;
  for (int i = 0; i < n->count; ++i) {
    global const float* line = samples + (size_t)n->at[i] * LINE;
    const float16 d0 = vload16(0, line) - a0, d1 = vload16(1, line) - a1;
    sum0 += d0;
    sum1 += d1;
    square0 = fma(d0, d0, square0);
    square1 = fma(d1, d1, square1);
    low0 = d0 < low0 ? d0 : low0;
    low1 = d1 < low1 ? d1 : low1;
    high0 = d0 > high0 ? d0 : high0;
    high1 = d1 > high1 ? d1 : high1;
  }
  const float16 sum[2] = {sum0, sum1}, square[2] = {square0, square1}, low[2] = {low0, low1}, high[2] = {high0, high1};
  for (int v = 0; v < 2; ++v) {
    const float16 mean = sum[v] / (float)n->count;
    const float16 variance = fma(-mean, mean, square[v] / (float)n->count);
    n->mean[v] = about[v] + mean;
    // Equal numbers: also those that differ by no more than the rounding of their sums.
    n->inverse_deviation[v] = low[v] < high[v] && variance > 0.0f ? 1.0f / sqrt(variance) : (float16)0.0f;
    n->low[v] = about[v] + low[v];
    n->high[v] = about[v] + high[v];
  }
}

typedef struct {
  int w, h;       // of the outer region
  int gx, gy;     // its place in the frame's grid
  int iteration;
  int radius;     // of the box
  float draws;    // for each of a pixel's samples, its own counted
  uint seed;
} Box;

// N of van de Vlasakker 2013, algorithm 6: own samples, then, row by row, those that are drawn and alike. A feature is
// alike within `deviations` of the pixel's own, or within `guard`: the printed test, bracketed so that it protects
// features without noise, says no more than that the larger of both decides.
void find(Neighbours* restrict n, global const float* restrict samples, Box b, int x, int y, int own, float16 deviations,
          float16 guard, global const uchar* restrict offsets) {
  uchar drawn[BOX_STRIDE * BOX_STRIDE];
  const int edge = 2 * b.radius + 1;
  for (int i = 0; i < edge * BOX_STRIDE; i += 16) vstore16((uchar16)0, 0, drawn + i);
  draw(key_of(b.seed, b.iteration, b.gx + x, b.gy + y), (int)(b.draws * (float)own) - own, own, offsets, drawn);
  drawn[b.radius * BOX_STRIDE + b.radius] = 0;

  const uint first = ((uint)y * b.w + x) * SLOTS;
  n->count = own;
  for (int s = 0; s < own; ++s) n->at[s] = first + s;
  float16 about[2];
  for (int v = 0; v < 2; ++v) about[v] = vload16(v, samples + (size_t)first * LINE);
  measure(n, samples, about);
  for (int v = 0; v < 2; ++v) about[v] = n->mean[v];
  const float16 inverse = n->inverse_deviation[0];
  const float16 allowed = inverse > 0.0f ? deviations / inverse : (float16)0.0f;
  const float16 distance = allowed > guard ? allowed : guard;
  const float16 low = about[0] - distance, high = about[0] + distance;

  int count = own;
  for (int qy = max(y - b.radius, 0); qy <= min(y + b.radius, b.h - 1); ++qy)
    for (int qx = max(x - b.radius, 0); qx <= min(x + b.radius, b.w - 1); ++qx) {
      uint bits = drawn[(qy - y + b.radius) * BOX_STRIDE + qx - x + b.radius];
      if (bits == 0) continue;
      const uint at = ((uint)qy * b.w + qx) * SLOTS;
      bits &= alike(samples + (size_t)at * LINE, low, high);
#pragma unroll
      for (int s = 0; s < SLOTS; ++s) {
        n->at[count] = at + s;
        count += bits >> s & 1;
      }
    }
  n->count = count;
  measure(n, samples, about);
}
