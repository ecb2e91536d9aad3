// SPDX-License-Identifier: Apache-2.0
// Non-local means: distances of patches, as in Rousselle, Knaus and Zwicker 2012, section 4. Behind common.cl.
//
// A work-item computes a chunk of CHUNK_WIDTH x `rows` pixels. For one offset it finds the distances of single pixels
// over the chunk and a margin, and sums them over the patches by columns and rows: the pixels of overlapping patches
// share them. Each sum is taken anew, in the same order wherever the chunk begins. Maps lie in the chunk's own part of
// a scratch buffer.
//
// Last what both filters by patches end with: their result as a picture.
//
// Planes are 0 in the pad and at invalid pixels, and plane 0 says which pixels are valid: 1, else 0. A patch's
// distance is the mean over the pairs of pixels of which both are valid.

// Radii and numbers of channels are constants only inside of what is inlined, and then loops over them unroll.

#define CHUNK_WIDTH 64
#define MARGIN 3                      // the largest radius of a patch
#define MAP_STRIDE (CHUNK_WIDTH + 16) // both margins and the rest of a vector
#define OFFSETS 4                     // whose maps are held at a time

typedef struct {
  int x, y, width, height;
  size_t origin;  // of its first pixel in a plane
} Chunk;

INLINE Chunk chunk_of(int rows, int stride, long origin, int x0, int y0, int x1, int y1) {
  const int across = (x1 - x0 + CHUNK_WIDTH - 1) / CHUNK_WIDTH, n = get_global_id(1);
  Chunk c;
  c.x = x0 + n % across * CHUNK_WIDTH;
  c.y = y0 + n / across * rows;
  c.width = min(CHUNK_WIDTH, x1 - c.x);
  c.height = min(rows, y1 - c.y);
  c.origin = origin + (size_t)c.y * stride + c.x;
  return c;
}

// What tells patches apart: planes of a picture and of its variance.
typedef struct {
  global const float *valid, *picture, *variance;
  long plane;
  int stride, channels;
  float k2;       // squared damping factor
  float epsilon;  // of the denominator
  float most;     // distance of two pixels
} Guide;

// Of three channels. Members, not an array: arrays stay in memory.
typedef struct {
  vf r, g, b;
} Rgb;

INLINE Rgb load_rgb(global const float* planes, size_t plane) {
  const Rgb v = {fetch(planes), fetch(planes + plane), fetch(planes + 2 * plane)};
  return v;
}

INLINE void store_rgb(Rgb v, global float* planes, size_t plane) {
  put(v.r, planes);
  put(v.g, planes + plane);
  put(v.b, planes + 2 * plane);
}

INLINE void add_rgb(Rgb v, global float* planes, size_t plane) {
  put(fetch(planes) + v.r, planes);
  put(fetch(planes + plane) + v.g, planes + plane);
  put(fetch(planes + 2 * plane) + v.b, planes + 2 * plane);
}

INLINE Rgb rgb_minus(Rgb a, Rgb b) {
  const Rgb v = {a.r - b.r, a.g - b.g, a.b - b.b};
  return v;
}

// a * b + c, by channel.
INLINE Rgb rgb_fma(Rgb a, Rgb b, Rgb c) {
  const Rgb v = {fma(a.r, b.r, c.r), fma(a.g, b.g, c.g), fma(a.b, b.b, c.b)};
  return v;
}

INLINE Rgb rgb_of(vf v) {
  const Rgb all = {v, v, v};
  return all;
}

INLINE vf least_of(vf a, vf b) { return a < b ? a : b; }
INLINE vf most_of(vf a, vf b) { return a > b ? a : b; }

// What is left of a squared difference when the noise that the variances account for is taken away, (vp + min(vp, vq)):
// Rousselle et al. 2012, equation 4.
INLINE vf excess(vf difference, vf vp, vf vq) { return fma(difference, difference, -(vp + least_of(vp, vq))); }

// Sum over the channels of the distances of pixel p's and q's values. `swapped`: as seen from q.
INLINE vf pixel_distance(Guide g, size_t p, size_t q, int swapped) {
  vf sum = 0.0f;
#pragma unroll
  for (int c = 0; c < g.channels; ++c) {
    const size_t at = c * g.plane;
    const vf vp = fetch(g.variance + at + p), vq = fetch(g.variance + at + q);
    const vf d = fetch(g.picture + at + p) - fetch(g.picture + at + q);
    sum += least_of(excess(d, swapped ? vq : vp, swapped ? vp : vq) / fma(vp + vq, (vf)g.k2, (vf)g.epsilon),
                    (vf)g.most);
  }
  return sum;
}

// Over the chunk and its margins, the pixels' distances from those `offset` further on, 0 where either is invalid.
// `pairs`, unless null: 1 where both are valid.
INLINE void pixel_map(Guide g, Chunk c, long offset, int margin, int swapped, global float* map, global float* pairs) {
  for (int y = -margin; y < c.height + margin; ++y)
    for (int x = -margin; x < c.width + margin; x += VW) {
      const size_t p = c.origin + (long)y * g.stride + x, q = p + offset;
      const size_t at = (size_t)(y + margin) * MAP_STRIDE + x + margin;
      const vf distance = pixel_distance(g, p, q, swapped);
      if (pairs) {
        const vf both = fetch(g.valid + p) * fetch(g.valid + q);
        put(both > (vf)0.0f ? distance : (vf)0.0f, map + at);
        put(both, pairs + at);
      } else {
        put(distance, map + at);
      }
    }
}

// Sums of a pixel map of the given margin along the rows of patches of `radius`, for each of its rows.
INLINE void row_sums(Chunk c, int margin, int radius, global const float* map, global float* sums) {
  for (int y = 0; y < c.height + 2 * margin; ++y)
    for (int x = 0; x < c.width; x += VW) {
      global const float* from = map + (size_t)y * MAP_STRIDE + x + margin;
      vf sum = fetch(from);
#pragma unroll
      for (int k = 1; k <= radius; ++k) sum += fetch(from - k) + fetch(from + k);
      put(sum, sums + (size_t)y * CHUNK_WIDTH + x);
    }
}

INLINE vf column_sum(global const float* sums, int radius) {
  vf sum = fetch(sums);
#pragma unroll
  for (int k = 1; k <= radius; ++k) sum += fetch(sums - k * CHUNK_WIDTH) + fetch(sums + k * CHUNK_WIDTH);
  return sum;
}

// Of one offset: for each pixel of the chunk, the mean distance of the patches of `radius`. Only where pairs are
// counted, `counts` tells how many: a chunk far from anything invalid has a constant number.
INLINE void patch_map(Chunk c, int margin, int radius, int channels, int plain, global const float* sums,
               global const float* pair_sums, global float* map, global float* counts) {
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t from = (size_t)(y + margin) * CHUNK_WIDTH + x, to = (size_t)y * CHUNK_WIDTH + x;
      const vf count = plain ? (vf)(float)((2 * radius + 1) * (2 * radius + 1))
                             : most_of(column_sum(pair_sums + from, radius), (vf)1.0f);
      put(column_sum(sums + from, radius) / (count * (float)channels), map + to);
      if (counts && !plain) put(count, counts + to);
    }
}

// Whether all pixels as far as `reach` from the chunk are valid.
INLINE int is_plain(global const float* valid, int stride, Chunk c, int reach) {
  vf least = 1.0f;
  for (int y = -reach; y < c.height + reach; ++y)
    for (int x = -reach; x < c.width + reach; x += VW)
      least = least_of(least, fetch(valid + c.origin + (long)y * stride + x));
  float lanes[VW];
  store(least, lanes);
  float all = 1.0f;
  for (int k = 0; k < VW; ++k) all = min(all, lanes[k]);
  return all > 0.0f;
}

// A chunk's part of the scratch buffer, behind which a kernel's own maps begin.
typedef struct {
  global float *map, *pairs, *sums, *pair_sums;
  global float* rest;
} Scratch;

INLINE size_t map_size(int rows) { return (size_t)MAP_STRIDE * (rows + 2 * MARGIN); }
INLINE size_t sums_size(int rows) { return (size_t)CHUNK_WIDTH * (rows + 2 * MARGIN); }
INLINE size_t chunk_size(int rows) { return (size_t)CHUNK_WIDTH * rows; }

// `own`: maps of chunk_size that the kernel takes for itself.
INLINE Scratch scratch_of(global float* scratch, int rows, int own) {
  Scratch s;
  s.map = scratch + get_global_id(1) * (2 * map_size(rows) + 2 * sums_size(rows) + own * chunk_size(rows));
  s.pairs = s.map + map_size(rows);
  s.sums = s.pairs + map_size(rows);
  s.pair_sums = s.sums + sums_size(rows);
  s.rest = s.pair_sums + sums_size(rows);
  return s;
}

// The patch distances of one offset and one radius.
INLINE void patch_distances(Guide g, Chunk c, Scratch s, long offset, int radius, int swapped, int plain, global float* to) {
  pixel_map(g, c, offset, radius, swapped, s.map, plain ? 0 : s.pairs);
  row_sums(c, radius, radius, s.map, s.sums);
  if (!plain) row_sums(c, radius, radius, s.pairs, s.pair_sums);
  patch_map(c, radius, radius, g.channels, plain, s.sums, s.pair_sums, to, 0);
}

// e^-d, 1 for d <= 0; 0 at invalid neighbours.
INLINE vf weight_of(vf d, vf valid) { return valid * exp2_of_negative(-LOG2_E * most_of(d, (vf)0.0f)); }

INLINE void clear(global float* maps, size_t floats) {
  for (size_t k = 0; k < floats; k += VW) put((vf)0.0f, maps + k);
}

// For each of `count` planes, at each pixel of the chunk, the sum over its window of the weights and of the weighted
// differences from the pixel: sums[0] and sums[1 .. count]. Weights by the guide's patches.
INLINE void smooth(Guide g, Chunk c, Scratch s, int rows, int window, int radius, int count, global const float* from,
            global float* sums) {
  const int plain = is_plain(g.valid, g.stride, c, window + radius);
  clear(sums, (count + 1) * chunk_size(rows));
  for (int j = -window; j <= window; ++j)
    for (int i = -window; i <= window; ++i) {
      const long offset = (long)j * g.stride + i;
      patch_distances(g, c, s, offset, radius, 0, plain, s.rest);
      for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; x += VW) {
          const size_t p = c.origin + (size_t)y * g.stride + x, q = p + offset, at = (size_t)y * CHUNK_WIDTH + x;
          const vf w = weight_of(fetch(s.rest + at), fetch(g.valid + q));
          put(fetch(sums + at) + w, sums + at);
          for (int k = 0; k < count; ++k) {
            global float* sum = sums + (k + 1) * chunk_size(rows) + at;
            put(fma(w, fetch(from + k * g.plane + q) - fetch(from + k * g.plane + p), fetch(sum)), sum);
          }
        }
    }
}

// The planes of `filtered` from `first` on, RGB, over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels
// keep their colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict base,
                   global const float* restrict filtered, int first, int stride, long plane, long origin, int x0, int y0,
                   int x1, int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = fetch(base + p) > (vf)0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, n, 0.0f);
      store_first(filtered_or_kept(valid, fetch(filtered + (first + c) * plane + p), color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
