// SPDX-License-Identifier: Apache-2.0
// Where the surfaces of VW pixels were seen one frame before, and what was kept of them there: shared by all filters
// with history. A pixel p was seen at q = p - motion(p), pixel centres at whole numbers of the frame's grid. Four taps
// around q, of which those of the same surface count, by their bilinear weights; where these hold less than a hundredth,
// those of the nine pixels around the nearest one, all alike (Schied et al. 2017, section 4.1); else none.
//
// The history's planes cover the region [past_x0, past_x1) x [past_y0, past_y1) of the frame's grid, without pads: a
// tap outside of it is outside of the frame. Taps of neighbouring lanes mostly are neighbours: runs of them are read as
// vectors, and only where there are many runs, or the planes' ends are near, lane by lane. Which of both ways is gone
// changes no bit, nor does what the other lanes do.
// HISTORY is defined where the filter has a history by which it tells surfaces with a Trace. Without motion there is
// nothing here but a word for vectors.

// Of a vector of pixels from x on those in [x0, x1), at p.
INLINE void store_between(vf v, global float* p, int x, int x0, int x1) {
  if (x >= x0) {
    if (x < x1) store_first(v, p, x1 - x);
    return;
  }
  float lanes[VW];
  store(v, lanes);
  for (int k = x0 - x; k < VW && k < x1 - x; ++k) p[k] = lanes[k];
}

#ifdef IN_MOTION
#ifdef IN_DEPTHGRADIENT
#define HISTORY
#endif

#define PAST_ARGUMENTS                                                                                          \
  global const float *restrict past, int past_x0, int past_y0, int past_x1, int past_y1, int outer_x, int outer_y
#define PAST_WIDTH (past_x1 - past_x0)
#define PAST_AREA ((size_t)PAST_WIDTH * (past_y1 - past_y0))

#if VW == 1
#define first_lane(v) (v)
#define to_float(v) convert_float(v)
#else
#define first_lane(v) ((v).s0)
#define to_float(v) JOIN(convert_float, VW)(v)
#endif

constant int kLanes[16] = {0, 1, 2, 3, 4, 5, 6, 7, 8, 9, 10, 11, 12, 13, 14, 15};
#define MOST_RUNS 8

// How many frames a pixel's history can be long: whoever says more errs.
#define LONGEST_HISTORY 128.0f

// The taps that a pixel may take from. Coordinates count from the region's first pixel.
typedef struct {
  vi wanted;         // lanes that have any
  vi x, y;           // of the tap up and left of q
  vf right, below;  // how far q is from it
  vi start;         // where lane 0's tap would be, were it in one run with this lane's
  int runs, run[MOST_RUNS], lowest, highest;  // the starts of the wanted lanes; no runs: there are too many
} Seen;

// `seen` is not copied: what has just been stored number by number is not to be read as a vector.
typedef struct {
  vi inside;
  const Seen* seen;
  int runs, offset;  // of seen's runs those that can be read; to be added to their starts
} Tap;

// The whole part, downwards.
INLINE vi whole(vf v) {
  const vi i = to_int(v);
  return i + (to_float(i) > v ? (vi)-1 : (vi)0);
}

// Finds the runs. Most often there is one.
INLINE void find_runs(Seen* s, int width) {
  s->start = s->y * width + s->x - load(kLanes);
  const int first = first_lane(s->start);
  if (!any_lane(!s->wanted | (s->start != (vi)first))) {
    s->runs = 1;
    s->run[0] = s->lowest = s->highest = first;
    return;
  }
  int starts[VW], wanted[VW];
  store(s->start, starts);
  store(s->wanted, wanted);
  s->runs = s->lowest = s->highest = 0;
  for (int k = 0; k < VW; ++k) {
    if (!wanted[k]) continue;
    int r = 0;
    while (r < s->runs && s->run[r] != starts[k]) ++r;
    if (r < s->runs) continue;
    if (r == MOST_RUNS) {
      s->runs = 0;
      return;
    }
    s->lowest = r > 0 ? min(s->lowest, starts[k]) : starts[k];
    s->highest = r > 0 ? max(s->highest, starts[k]) : starts[k];
    s->run[s->runs++] = starts[k];
  }
}

// x, y: of lane 0, in the frame's grid.
INLINE void seen_before(int x, int y, vf motion_x, vf motion_y, int past_x0, int past_y0, int past_x1, int past_y1,
                        Seen* s) {
  vf qx = to_float((vi)x + load(kLanes)) - motion_x, qy = (vf)(float)y - motion_y;
  s->wanted = (qx > (vf)(float)(past_x0 - 3)) & (qx < (vf)(float)(past_x1 + 3)) & (qy > (vf)(float)(past_y0 - 3)) &
             (qy < (vf)(float)(past_y1 + 3));
  qx = s->wanted ? qx : (vf)(float)past_x0;
  qy = s->wanted ? qy : (vf)(float)past_y0;
  const vi at_x = whole(qx), at_y = whole(qy);
  s->right = qx - to_float(at_x);
  s->below = qy - to_float(at_y);
  s->x = at_x - past_x0;
  s->y = at_y - past_y0;
  find_runs(s, PAST_WIDTH);
}

// Of the VW pixels from (x, y) of the outer region on, whose input begins at `in`; n of them are ours.
#define FIND_SEEN(seen, in, area, n, x, y)                                                                     \
  seen_before(outer_x + (x), outer_y + (y), load_first((in) + IN_MOTION * (area), n, INFINITY),                 \
              load_first((in) + (IN_MOTION + 1) * (area), n, INFINITY), past_x0, past_y0, past_x1, past_y1, seen)

// The tap (i, j) from the one up and left of q.
INLINE Tap tap_of(const Seen* s, int i, int j, int width, int height) {
  Tap t;
  const vi x = s->x + i, y = s->y + j;
  t.inside = s->wanted & (x >= (vi)0) & (x < (vi)width) & (y >= (vi)0) & (y < (vi)height);
  t.seen = s;
  t.offset = j * width + i;
  t.runs = s->lowest + t.offset >= 0 && s->highest + t.offset + VW <= width * height ? s->runs : 0;
  return t;
}

// Where there is no tap, any number.
INLINE vf at_tap(global const float* plane, Tap t) {
  if (t.runs > 0) {
    const int* run = t.seen->run;
    vf v = fetch(plane + (run[0] + t.offset));
    for (int r = 1; r < t.runs; ++r) v = t.seen->start == (vi)run[r] ? fetch(plane + (run[r] + t.offset)) : v;
    return v;
  }
  float values[VW];
  int index[VW];
  store(t.inside ? t.seen->start + load(kLanes) + t.offset : (vi)0, index);
  for (int k = 0; k < VW; ++k) values[k] = plane[index[k]];
  return load(values);
}

// Where lanes of q's four taps yielded nothing, those of the nine around the nearest pixel come next.
INLINE void look_around(Seen* s, vi lost, int width) {
  s->wanted &= lost;
  s->x += s->right >= (vf)0.5f ? (vi)1 : (vi)0;
  s->y += s->below >= (vf)0.5f ? (vi)1 : (vi)0;
  find_runs(s, width);
}

INLINE vf bilinear(const Seen* s, int i, int j) {
  return (i ? s->right : 1.0f - s->right) * (j ? s->below : 1.0f - s->below);
}

// Runs BODY for each tap, which finds `tap`, sets the COUNT numbers value[], and says in `taken` where they are to count:
// to begin with, where there is a tap. There the tap's weight is added to SUM, and to each of TOTAL[] the weight times
// its value: nowhere else, for what is not taken may be no number. A `continue` passes over a tap that nobody takes.
// LAST: 4, or 13 with the nine. SEEN, a pointer, ends up as what was looked at last.
#define FOR_EACH_PAST_TAP(SEEN, SUM, TOTAL, COUNT, LAST, BODY)                                                    \
  if (any_lane((SEEN)->wanted)) {                                                                                 \
    _Pragma("nounroll") for (int tap_number = 0; tap_number < (LAST); ++tap_number) {                             \
      if (tap_number == 4) {                                                                                      \
        const vi lost = (SUM) < (vf)0.01f;                                                                        \
        (SUM) = lost ? (vf)0.0f : (SUM);                                                                          \
        _Pragma("unroll") for (int c = 0; c < (COUNT); ++c) (TOTAL)[c] = lost ? (vf)0.0f : (TOTAL)[c];            \
        look_around(SEEN, lost, PAST_WIDTH);                                                                      \
        if (!any_lane((SEEN)->wanted)) break;                                                                     \
      }                                                                                                           \
      const int tap_i = tap_number < 4 ? tap_number % 2 : (tap_number - 4) % 3 - 1;                               \
      const int tap_j = tap_number < 4 ? tap_number / 2 : (tap_number - 4) / 3 - 1;                               \
      const Tap tap = tap_of(SEEN, tap_i, tap_j, PAST_WIDTH, past_y1 - past_y0);                                  \
      const vf weight = tap_number < 4 ? bilinear(SEEN, tap_i, tap_j) : (vf)1.0f;                                 \
      vf value[COUNT];                                                                                            \
      vi taken = tap.inside;                                                                                      \
      BODY                                                                                                        \
      (SUM) += taken ? weight : (vf)0.0f;                                                                         \
      _Pragma("unroll") for (int c = 0; c < (COUNT); ++c)                                                         \
        (TOTAL)[c] = taken ? fma(weight, value[c], (TOTAL)[c]) : (TOTAL)[c];                                      \
    }                                                                                                             \
  }

INLINE vf rounded(vf v) {
  const vf to_whole = 12582912.0f;  // 1.5 * 2^23
  return (v + to_whole) - to_whole;
}

// How long the history is with this frame. `before`: the sum of weight times length.
INLINE vf longer(vf sum, vf before) {
  const vf mean = rounded(before / sum);
  const vf next = mean < (vf)(LONGEST_HISTORY - 1) ? mean + 1.0f : (vf)LONGEST_HISTORY;
  return sum > (vf)0.0f ? next : (vf)1.0f;
}

// The weight of this frame. `plain`: while the history is shorter than 1 / alpha, all of its frames weigh the same.
INLINE vf weight_of_now(vf length, float alpha, int plain) {
  const vf equal = 1.0f / length;
  const vf least = plain ? equal : (vf)0.0f;
  const vf weight = least > (vf)alpha ? least : (vf)alpha;
  return length > (vf)1.0f ? weight : (vf)1.0f;
}

#ifdef HISTORY
// What tells whether a pixel before is of the same surface. In a history five planes: depth, normal, object.
typedef struct {
  vf depth, tolerance;
  vf normal[3];
  vf object;
} Trace;

// Of VW pixels from `in`, of which n are ours. The depth is what it was one frame before; it may differ by twice its
// change from pixel to pixel along both axes, for taps are up to two pixels off, and by a hundredth.
INLINE Trace expected_trace(global const float* in, size_t area, int n) {
  Trace t;
  const vf right = load_first(in + IN_DEPTHGRADIENT * area, n, 0.0f);
  const vf down = load_first(in + (IN_DEPTHGRADIENT + 1) * area, n, 0.0f);
  t.depth = load_first(in + IN_PREVIOUS * area, n, 0.0f);
  t.tolerance = fma((vf)2.0f, fabs(right) + fabs(down), 0.01f * fabs(t.depth));
  for (int c = 0; c < 3; ++c) t.normal[c] = load_first(in + (IN_NG + c) * area, n, 0.0f);
  t.object = load_first(in + IN_OBJECTID * area, n, 0.0f);
  return t;
}

INLINE vi same_surface(Trace t, global const float* planes, size_t area, Tap tap) {
  const vf x = at_tap(planes + area, tap) - t.normal[0], y = at_tap(planes + 2 * area, tap) - t.normal[1],
           z = at_tap(planes + 3 * area, tap) - t.normal[2];
  return tap.inside & (fabs(at_tap(planes, tap) - t.depth) <= t.tolerance) &
         (at_tap(planes + 4 * area, tap) == t.object) & (fma(x, x, fma(y, y, z * z)) < (vf)0.25f);
}

// Keeps the trace that the next frame compares with; zeros where `valid` is not.
INLINE void keep_trace(global const float* in, size_t area, int n, vi valid, global float* to, size_t to_area, int x, int x0,
                int x1) {
  const int planes[5] = {IN_DEPTH, IN_NG, IN_NG + 1, IN_NG + 2, IN_OBJECTID};
  for (int c = 0; c < 5; ++c) {
    const vf v = load_first(in + planes[c] * area, n, 0.0f);
    store_between(valid ? v : (vf)0.0f, to + c * to_area, x, x0, x1);
  }
}
#endif  // HISTORY
#endif  // IN_MOTION
