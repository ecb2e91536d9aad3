// SPDX-License-Identifier: Apache-2.0
// The temporal part of SVGF (Schied et al. 2017, sections 4.1 and 4.2): light and what tells its variance, accumulated
// over frames.
//   history: 0..2 direct   3..5 indirect   then KEPT_STATISTICS planes   then the history's length, and a trace
// MOMENTS: the statistics are mean and variance of the luminance of direct light, then of indirect. Without it they are
// the variances of what was accumulated.
#ifdef HISTORY

#ifdef MOMENTS
#define KEPT_STATISTICS 4
#else
#define KEPT_STATISTICS 2
#endif
#define KEPT_LENGTH (6 + KEPT_STATISTICS)
#define KEPT_TRACE (KEPT_LENGTH + 1)
#define TOTALS (KEPT_LENGTH + 1)

INLINE vi variance_like(vf v) { return (v >= (vf)0.0f) & (v <= (vf)LARGEST_VARIANCE); }

// What a tap keeps, as numbers to be averaged: light and luminance less that of now, variances as they are, the moment
// about now's luminance. Whether all of them can be.
INLINE vi kept_at(global const float* past, size_t area, Tap tap, const vf* light, const vf* bright, vf* value) {
  vi fit = (vi)-1;
#pragma unroll
  for (int c = 0; c < 6; ++c) {
    const vf v = at_tap(past + c * area, tap);
    fit &= ordinary(v);
    value[c] = v - light[c];
  }
#ifdef MOMENTS
#pragma unroll
  for (int s = 0; s < 2; ++s) {
    const vf mean = at_tap(past + (6 + 2 * s) * area, tap), variance = at_tap(past + (7 + 2 * s) * area, tap);
    fit &= ordinary(mean) & variance_like(variance);
    value[6 + 2 * s] = bounded_step(mean - bright[s]);
    value[7 + 2 * s] = fma(value[6 + 2 * s], value[6 + 2 * s], variance);
  }
#else
#pragma unroll
  for (int s = 0; s < 2; ++s) {
    value[6 + s] = at_tap(past + (6 + s) * area, tap);
    fit &= variance_like(value[6 + s]);
  }
#endif
  value[KEPT_LENGTH] = at_tap(past + KEPT_LENGTH * area, tap);
  return fit & (value[KEPT_LENGTH] >= (vf)1.0f) & (value[KEPT_LENGTH] <= (vf)LONGEST_HISTORY);
}

// guides, signal, raw: as `prepare` makes them, but of what is accumulated; with MOMENTS the signal's variance, too.
// Guides' plane 4 is the history's length. alpha: of light, of the moments. Keeps all but the light, and that if `kept`
// says so.
kernel void svgf_accumulate(global const float* restrict input, int w, int h, global float* restrict guides,
                            global float* restrict signal, global float* restrict raw, int stride, long plane,
                            long origin, PAST_ARGUMENTS, KEPT_ARGUMENTS, float2 alpha, int plain) {
  const int y = get_global_id(1), x0 = kept_x0, x1 = kept_x1;
  const size_t area = (size_t)w * h, past_area = PAST_AREA, out_area = (size_t)(x1 - x0) * (kept_y1 - kept_y0);
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const Pixels now = pixels_at(in, area, n);
    const vi valid = now.valid;
    const vf* light = now.light;
    const Trace trace = expected_trace(in, area, n);
    Seen seen;
    FIND_SEEN(&seen, in, area, n, x, y);
    seen.wanted &= valid;
    vf bright[2], total[TOTALS], sum = 0.0f;
#pragma unroll
    for (int s = 0; s < 2; ++s) bright[s] = luminance(light[3 * s], light[3 * s + 1], light[3 * s + 2]);
#pragma unroll
    for (int c = 0; c < TOTALS; ++c) total[c] = 0.0f;
    FOR_EACH_PAST_TAP(&seen, sum, total, TOTALS, 13, {
      taken = same_surface(trace, past + KEPT_TRACE * past_area, past_area, tap);
      if (!any_lane(taken)) continue;
      taken &= kept_at(past, past_area, tap, light, bright, value);
    })
    const vf length = longer(sum, total[KEPT_LENGTH]), per_sum = sum > (vf)0.0f ? 1.0f / sum : (vf)0.0f;
    const vf old = (1.0f - weight_of_now(length, alpha.x, plain)) * per_sum;
    store_guides(&now, guides, plane, p);
    vf mixed[6];
#pragma unroll
    for (int c = 0; c < 6; ++c) {
      mixed[c] = fma(old, total[c], light[c]);
      store(mixed[c], signal + c * plane + p);
    }
    store(valid ? length : (vf)0.0f, guides + 4 * plane + p);
    vf statistics[KEPT_STATISTICS];
#ifdef MOMENTS
    const vf older = (1.0f - weight_of_now(length, alpha.y, plain)) * per_sum;
#pragma unroll
    for (int s = 0; s < 2; ++s) {
      const vf step = older * total[6 + 2 * s], variance = fma(older, total[7 + 2 * s], -step * step);
      statistics[2 * s] = bright[s] + step;
      statistics[2 * s + 1] = variance > (vf)0.0f ? variance : (vf)0.0f;
      store(statistics[2 * s + 1], signal + (6 + s) * plane + p);
      store(luminance(mixed[3 * s], mixed[3 * s + 1], mixed[3 * s + 2]), raw + (6 + s) * plane + p);
    }
#else
    const vf share = weight_of_now(length, alpha.x, plain), squared = (1.0f - share) * (1.0f - share) * per_sum;
#pragma unroll
    for (int s = 0; s < 2; ++s) {
      const vf variance = fma(squared, total[6 + s], share * share * now.variance[s]);
      statistics[s] = variance < (vf)LARGEST_VARIANCE ? variance : (vf)LARGEST_VARIANCE;
      store(statistics[s], raw + (6 + s) * plane + p);
    }
#endif
    if (y < kept_y0 || y >= kept_y1) continue;
    keep_light(mixed, kept, kept_x0, kept_y0, x1, kept_y1, output, x, y);
    global float* out = output + (size_t)(y - kept_y0) * (x1 - x0) + (x - x0);
#pragma unroll
    for (int s = 0; s < KEPT_STATISTICS; ++s)
      store_between(valid ? statistics[s] : (vf)0.0f, out + (3 + 6 + s) * out_area, x, x0, x1);
    store_between(valid ? length : (vf)0.0f, out + (3 + KEPT_LENGTH) * out_area, x, x0, x1);
    keep_trace(in, area, n, valid, out + (3 + KEPT_TRACE) * out_area, out_area, x, x0, x1);
  }
}
#endif  // HISTORY
