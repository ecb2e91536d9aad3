// SPDX-License-Identifier: Apache-2.0
// The accumulation of light before the fit (Koskela et al. 2019, section 3.2), and what was filtered of it before, which
// is mixed in after the fit, by the same taps. While a pixel has been seen in few frames they all weigh the same.
//   OBJECTS: whether the surface may have moved, and is then told by depth and object

// Planes over the outer region: light (scaled down), how many frames it is of, 0 where not valid; what was filtered.
#define COUNT 3
#define BEFORE 4
#define ACCUMULATED 7

// Planes of the history, of light in its own units; all 0 where not valid.
#define KEPT_COUNT 3
#define KEPT_NORMAL 4
#define KEPT_POSITION 7
#define KEPT_DEPTH 10
#define KEPT_OBJECT 11
#define KEPT_FILTERED (OBJECTS ? 12 : 10)

#if TEMPORAL
#define LARGEST_COUNT 255.0f

// The squared distance from `position` to the surface points seen from pixel x of a row on; infinite where none is.
INLINE vf squared_distance(global const float* row, size_t area, int w, int x, const vf* position) {
  const vf depth = load_in_row(row + IN_DEPTH * area, x, w, INFINITY);
  vf sum = 0.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf d = load_in_row(row + (IN_P + c) * area, x, w, 0.0f) - position[c];
    sum = fma(d, d, sum);
  }
  return depth < (vf)SKY && sum < (vf)INFINITY ? sum : (vf)INFINITY;
}

INLINE vf nearer_if_any(vf a, vf b) {
  const vf least = a < b ? a : b;
  return least < (vf)INFINITY ? least : (vf)0.0f;
}

// Squared distance to the next pixel's surface point, per axis on the nearer side, both axes as a diagonal.
INLINE vf squared_footprint(global const float* input, int w, int h, int x, int y, const vf* position) {
  const size_t area = (size_t)w * h;
  global const float* row = input + (size_t)y * w;
  const vf across = nearer_if_any(squared_distance(row, area, w, x - 1, position), squared_distance(row, area, w, x + 1, position));
  const vf above = y > 0 ? squared_distance(row - w, area, w, x, position) : (vf)INFINITY;
  const vf below = y + 1 < h ? squared_distance(row + w, area, w, x, position) : (vf)INFINITY;
  return across + nearer_if_any(above, below);
}

// What tells whether a pixel before is of the same surface.
typedef struct {
  vf normal[3], position[3], depth, object;
  vf largest, largest_turn;  // squared
} Surface;

INLINE vi same_surface(const Surface* s, global const float* past, size_t area, Tap tap) {
  vf distance = 0.0f, turn = 0.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf p = at_tap(past + (KEPT_POSITION + c) * area, tap) - s->position[c];
    const vf n = at_tap(past + (KEPT_NORMAL + c) * area, tap) - s->normal[c];
    distance = fma(p, p, distance);
    turn = fma(n, n, turn);
  }
  vi near = distance <= s->largest, finite = distance < (vf)INFINITY;
#if OBJECTS
  const vf deeper = at_tap(past + KEPT_DEPTH * area, tap) - s->depth;
  const vf object = at_tap(past + KEPT_OBJECT * area, tap);
  near |= (deeper * deeper <= s->largest) & (object == s->object);
  finite &= (deeper * deeper < (vf)INFINITY) & ordinary(object);
#endif
  return near & finite & (turn < s->largest_turn);
}

// Sums over the taps of the same surface, by their bilinear weights: light, frames, filtered light. Their sum of weights.
INLINE vf sums_before(Seen* place, const Surface* s, global const float* past, int past_x0, int past_y0, int past_x1,
               int past_y1, vf* total) {
  vf sum = 0.0f;
#pragma unroll
  for (int c = 0; c < ACCUMULATED; ++c) total[c] = 0.0f;
  FOR_EACH_PAST_TAP(place, sum, total, ACCUMULATED, 4, {
    taken &= same_surface(s, past, PAST_AREA, tap);
    _Pragma("unroll")
    for (int c = 0; c < ACCUMULATED; ++c) {
      value[c] = at_tap(past + (c < BEFORE ? c : KEPT_FILTERED + c - BEFORE) * PAST_AREA, tap);
      taken &= ordinary(value[c]);
    }
    taken &= (value[COUNT] >= (vf)1.0f) & (value[COUNT] <= (vf)LARGEST_COUNT);
  })
  return sum;
}

// The light of this frame and the mean before, mixed. sum: of the weights of what is in `total`; too small ones say
// nothing.
INLINE void accumulate(const Pixel* s, vf sum, const vf* total, float alpha, vf* kept) {
  const vi known = sum >= (vf)0.01f;
  const vf scale = 1.0f / sum, frames = total[COUNT] * scale;
  const vf equal = 1.0f / (frames + 1.0f), share = equal > (vf)alpha ? equal : (vf)alpha;
  const vf next = rounded(frames) + 1.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    const vf then = total[c] * scale * DOWN;
    kept[c] = known ? fma(share, s->light[c] - then, then) : s->light[c];
    kept[BEFORE + c] = known ? total[BEFORE + c] * scale : (vf)0.0f;
  }
  const vf count = known ? (next < (vf)LARGEST_COUNT ? next : (vf)LARGEST_COUNT) : (vf)1.0f;
  kept[COUNT] = s->valid ? count : (vf)0.0f;
}

// What was filtered before, mixed with what is now.
INLINE void mix_in_filtered(const vf* kept, float alpha, vf* light) {
  const vf equal = 1.0f / kept[COUNT], share = equal > (vf)alpha ? equal : (vf)alpha;
#pragma unroll
  for (int c = 0; c < 3; ++c) light[c] = fma(share, light[c] - kept[BEFORE + c], kept[BEFORE + c]);
}

// limits: of a distance in footprints, of one in the world's unit (0: by footprints), of normals.
kernel void bmfr_accumulate(global const float* restrict input, int w, int h, PAST_ARGUMENTS, float alpha, float4 limits,
                            int x0, int y0, int x1, int y1, global float* restrict accumulated) {
  const int y = y0 + get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    global const float* at = input + (size_t)y * w + x;
    const int n = w - x;
    vf in[CHANNELS], total[ACCUMULATED], kept[ACCUMULATED];
#pragma unroll
    for (int c = 0; c < CHANNELS; ++c) in[c] = load_first(at + c * area, n, 0.0f);
    const Pixel s = pixel_of(in, 0.0f);
    Surface surface;
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      surface.normal[c] = in[IN_N + c];
      surface.position[c] = in[IN_P + c];
    }
    surface.largest = limits.y > 0 ? (vf)(limits.y * limits.y)
                                   : limits.x * limits.x * squared_footprint(input, w, h, x, y, in + IN_P);
    surface.largest_turn = limits.z * limits.z;
#if OBJECTS
    surface.depth = load_first(at + IN_PREVIOUS * area, n, 0.0f);
    surface.object = load_first(at + IN_OBJECTID * area, n, 0.0f);
#endif
    Seen place;
    FIND_SEEN(&place, at, area, n, x, y);
    place.wanted &= s.valid;
    const vf sum = sums_before(&place, &surface, past, past_x0, past_y0, past_x1, past_y1, total);
    accumulate(&s, sum, total, alpha, kept);
#pragma unroll
    for (int c = 0; c < ACCUMULATED; ++c) store_first(kept[c], accumulated + c * area + (size_t)y * w + x, x1 - x);
  }
}
#endif
