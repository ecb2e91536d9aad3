// SPDX-License-Identifier: Apache-2.0
// Temporal anti-aliasing (Karis 2014): each pixel is mixed with where it was seen one frame before, by the longest
// motion around it, so that a moving edge takes its antialiased border along. What the old picture holds is first
// drawn towards the mean of the 3x3 pixels until it is within `gamma` standard deviations of it in Y, Co and Cg. The
// weights fall with luminance, 1 / (1 + L), or a highlight would flicker for all.
//
// "Around" are the pixels of the picture over [px0, px1) x [py0, py1) of the outer region, that is of the frame.

#ifdef IN_MOTION
#define NOWHERE 1e30f
#define LONGEST 1e12f  // squared motion; what is beyond was not in the picture
#define LARGEST_SQUARE 1e36f

// The pixels around: rows of `width`; i, j: the middle one. Rows and columns that are not there are taken for the middle
// one's, and do not count.
typedef struct {
  int i, width, rows[3];
  bool inner;            // all of them are there
  vi beside[3], counts[3][3];
} Around;

INLINE bool is_inner(int i, int width, int j, int height) {
  return i >= 1 && i + VW < width && j >= 1 && j + 1 < height;
}

// inner: a constant where it is true, so that nothing is left of what counts.
INLINE Around around(int i, int width, int j, int height, bool inner) {
  Around a = {i, width, {inner ? j - 1 : max(j - 1, 0), j, inner ? j + 1 : min(j + 1, height - 1)}, inner};
#pragma unroll
  for (int k = 0; k < 3; ++k) {
    const vi number = (vi)(i + k - 1) + load(kLanes);
    a.beside[k] = (number >= 0) & (number < width);
  }
#pragma unroll
  for (int r = 0; r < 3; ++r)
#pragma unroll
    for (int k = 0; k < 3; ++k)
      a.counts[r][k] = inner ? (vi)-1 : a.beside[k] & (r == 1 || a.rows[r] != j ? (vi)-1 : (vi)0);
  return a;
}

INLINE vf beside(global const float* row, const Around* a, int k) {
  return a->inner ? fetch(row + a->i + k - 1) : load_in_row(row, a->i + k - 1, a->width, 0.0f);
}

INLINE void longest_motion(global const float* motion, size_t area, int stride, const Around* a, vf* mx, vf* my) {
  vf longest = -1.0f;
  *mx = *my = NOWHERE;
#pragma unroll
  for (int r = 0; r < 3; ++r) {
    global const float* row = motion + (long)a->rows[r] * stride;
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      const vf x = beside(row, a, k), y = beside(row + area, a, k);
      const vf length = fma(x, x, y * y);
      const vi longer = a->counts[r][k] & (length > longest) & (length < (vf)LONGEST);
      longest = longer ? length : longest;
      *mx = longer ? x : *mx;
      *my = longer ? y : *my;
    }
  }
}

// 4 Y, 2 Co and 4 Cg of a difference of colours: whole numbers of its channels, so a power of two is all that they
// differ by from what is meant. And back, of Y, Co and Cg.
constant float kPart[3] = {0.25f, 0.5f, 0.25f};
INLINE void to_luma_chroma(const vf* rgb, vf* out) {
  const vf rb = rgb[0] + rgb[2];
  out[0] = fma((vf)2.0f, rgb[1], rb);
  out[1] = rgb[0] - rgb[2];
  out[2] = fma((vf)2.0f, rgb[1], -rb);
}
INLINE void to_rgb(const vf* in, vf* rgb) {
  rgb[0] = in[0] + in[1] - in[2];
  rgb[1] = in[0] + in[2];
  rgb[2] = in[0] - in[1] - in[2];
}

// Of the colours around, as differences from the middle one.
typedef struct {
  vf centre[3], mean[3], deviation[3];
  vi finite;
} Statistics;

INLINE Statistics statistics(global const float* picture, size_t area, const Around* a) {
  Statistics s;
  vf count = 0.0f, squares[3];
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    s.centre[c] = beside(picture + c * area + (long)a->rows[1] * a->width, a, 1);
    s.mean[c] = squares[c] = 0.0f;
  }
#pragma unroll
  for (int r = 0; r < 3; ++r)
#pragma unroll
    for (int k = 0; k < 3; ++k) {
      vf rgb[3], d[3];
#pragma unroll
      for (int c = 0; c < 3; ++c) {
        const vf v = beside(picture + c * area + (long)a->rows[r] * a->width, a, k);
        rgb[c] = a->counts[r][k] ? v - s.centre[c] : (vf)0.0f;
      }
      to_luma_chroma(rgb, d);
      count += a->counts[r][k] ? (vf)1.0f : (vf)0.0f;
#pragma unroll
      for (int c = 0; c < 3; ++c) {
        s.mean[c] += d[c];
        squares[c] = fma(d[c], d[c], squares[c]);
      }
    }
  const vf scale = 1.0f / count;
#pragma unroll
  for (int c = 0; c < 3; ++c) squares[c] *= kPart[c] * kPart[c];
  s.finite = squares[0] + squares[1] + squares[2] <= (vf)LARGEST_SQUARE;
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    s.mean[c] *= scale * kPart[c];
    const vf variance = fma(squares[c], scale, -s.mean[c] * s.mean[c]);
    s.deviation[c] = sqrt(variance > (vf)0.0f ? variance : (vf)0.0f);
  }
  return s;
}

// `rgb` drawn to the mean until no channel is farther from it than gamma deviations.
INLINE void clip(const Statistics* s, float gamma, vf* rgb) {
  vf offset[3], d[3], scale = 1.0f;
#pragma unroll
  for (int c = 0; c < 3; ++c) offset[c] = rgb[c] - s->centre[c];
  to_luma_chroma(offset, d);
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    d[c] = fma(d[c], (vf)kPart[c], -s->mean[c]);
    const vf most = fma(s->deviation[c], (vf)gamma, (vf)1e-30f) / fabs(d[c]);
    scale = most < scale ? most : scale;
  }
#pragma unroll
  for (int c = 0; c < 3; ++c) d[c] = fma(d[c], scale, s->mean[c]);
  to_rgb(d, offset);
#pragma unroll
  for (int c = 0; c < 3; ++c) rgb[c] = scale < (vf)1.0f ? s->centre[c] + offset[c] : rgb[c];
}

// The mixture of the picture and what was clipped. It is the picture plus a part of the difference: where nothing
// moves, nothing changes.
INLINE void mix_in(const Statistics* s, vi known, float alpha, vf* rgb) {
  const vf now = luminance(s->centre[0], s->centre[1], s->centre[2]), then = luminance(rgb[0], rgb[1], rgb[2]);
  // Each one's weight times both luminances and 1: one division instead of three.
  const vf new_weight = alpha * (1.0f + (then > (vf)0.0f ? then : (vf)0.0f));
  const vf old_weight = (1.0f - alpha) * (1.0f + (now > (vf)0.0f ? now : (vf)0.0f));
  const vf share = old_weight / (new_weight + old_weight);
#pragma unroll
  for (int c = 0; c < 3; ++c) rgb[c] = known ? fma(share, rgb[c] - s->centre[c], s->centre[c]) : s->centre[c];
}

// The old picture where the pixels were seen, between the four pixels there, as far as they are in the frame and
// finite. At least a quarter of their weight must be, or nothing is known.
INLINE vi picture_before(Seen* place, global const float* past, int past_x0, int past_y0, int past_x1, int past_y1, vf* rgb) {
  vf sum = 0.0f, total[3] = {0.0f, 0.0f, 0.0f};
  FOR_EACH_PAST_TAP(place, sum, total, 3, 4, {
    _Pragma("unroll") for (int c = 0; c < 3; ++c) {
      value[c] = at_tap(past + c * PAST_AREA, tap);
      taken &= ordinary(value[c]);
    }
  })
  const vi known = sum >= (vf)0.25f;
  const vf scale = 1.0f / sum;
#pragma unroll
  for (int c = 0; c < 3; ++c) rgb[c] = known ? total[c] * scale : (vf)0.0f;
  return known;
}

// Of the pixels (x, y) on, RGB. `a`: around them, in the picture. motion: from the picture's first pixel on.
INLINE void mixed(const Around* a, global const float* picture, size_t picture_area, global const float* motion,
                  size_t area, int w, PAST_ARGUMENTS, int x, int y, float alpha, float gamma, vf* rgb) {
  const Statistics s = statistics(picture, picture_area, a);
  vf mx, my;
  longest_motion(motion, area, w, a, &mx, &my);
  Seen place;
  seen_before(outer_x + x, outer_y + y, mx, my, past_x0, past_y0, past_x1, past_y1, &place);
  const vi known = picture_before(&place, past, past_x0, past_y0, past_x1, past_y1, rgb) & s.finite;
  clip(&s, gamma, rgb);
  mix_in(&s, known, alpha, rgb);
}

// picture: RGB over the pixels [px0, px1) x [py0, py1) of the outer region. past: of its planes the last three, from
// number `first` on, are the old picture. output: RGB over [x0, x1) x [y0, y1), and the same again as the last planes
// of the history.
kernel void taa(global const float* restrict input, int w, int h, global const float* restrict picture, int px0, int py0,
                int px1, int py1, PAST_ARGUMENTS, int first, float alpha, float gamma, int x0, int y0, int x1, int y1,
                global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row, width = px1 - px0;
  const size_t area = (size_t)w * h, picture_area = (size_t)width * (py1 - py0);
  const size_t out_area = (size_t)(x1 - x0) * (y1 - y0);
  global const float* motion = input + IN_MOTION * area + (size_t)py0 * w + px0;
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const int i = x - px0, j = y - py0, height = py1 - py0;
    const bool inner = is_inner(i, width, j, height);
    vf rgb[3];
#define MIX(inner)                                                                                                   \
  {                                                                                                                  \
    const Around a = around(i, width, j, height, inner);                                                             \
    mixed(&a, picture, picture_area, motion, area, w, past + first * PAST_AREA, past_x0, past_y0, past_x1, past_y1, \
          outer_x, outer_y, x, y, alpha, gamma, rgb);                                                                \
  }
    if (inner)
      MIX(true)
    else
      MIX(false)
#undef MIX
    global float* out = output + (size_t)row * (x1 - x0) + (x - x0);
#pragma unroll
    for (int c = 0; c < 3; ++c) {
      store_first(rgb[c], out + c * out_area, x1 - x);
      store_first(rgb[c], out + (3 + first + c) * out_area, x1 - x);
    }
  }
}
#endif
