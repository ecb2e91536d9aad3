// SPDX-License-Identifier: Apache-2.0
// EAW's illumination accumulated over frames, as SVGF's is (Schied et al. 2017, section 4.1), before its levels.
//   history: 0..2 illumination   3 the history's length   4..8 a trace
#ifdef HISTORY

// signal: of this frame; accumulated where it lies. Keeps the history over the pixels [x0, x1) x [y0, y1).
kernel void atrous_accumulate(global const float* restrict input, int w, int h, global const float* restrict guides,
                              global float* restrict signal, int stride, long plane, long origin, PAST_ARGUMENTS,
                              int x0, int y0, int x1, int y1, global float* restrict output, float alpha, int plain) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h, past_area = PAST_AREA, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(guides + p) < (vf)INFINITY;
    const Trace trace = expected_trace(in, area, n);
    Seen seen;
    FIND_SEEN(&seen, in, area, n, x, y);
    seen.wanted &= valid;
    vf light[3], total[4], sum = 0.0f;
    for (int c = 0; c < 3; ++c) light[c] = load(signal + c * plane + p);
    for (int c = 0; c < 4; ++c) total[c] = 0.0f;
    FOR_EACH_PAST_TAP(&seen, sum, total, 4, 13, {
      taken = same_surface(trace, past + 4 * past_area, past_area, tap);
      if (!any_lane(taken)) continue;
      for (int c = 0; c < 3; ++c) {
        const vf v = at_tap(past + c * past_area, tap);
        taken &= ordinary(v);
        value[c] = v - light[c];
      }
      value[3] = at_tap(past + 3 * past_area, tap);
      taken &= (value[3] >= (vf)1.0f) & (value[3] <= (vf)LONGEST_HISTORY);
    })
    const vf length = longer(sum, total[3]), per_sum = sum > (vf)0.0f ? 1.0f / sum : (vf)0.0f;
    const vf old = (1.0f - weight_of_now(length, alpha, plain)) * per_sum;
    for (int c = 0; c < 3; ++c) {
      light[c] = fma(old, total[c], light[c]);
      store(light[c], signal + c * plane + p);
    }
    if (y < y0 || y >= y1) continue;
    global float* out = output + (size_t)(y - y0) * (x1 - x0) + (x - x0);
    for (int c = 0; c < 3; ++c) store_between(light[c], out + (3 + c) * out_area, x, x0, x1);
    store_between(valid ? length : (vf)0.0f, out + 6 * out_area, x, x0, x1);
    keep_trace(in, area, n, valid, out + 7 * out_area, out_area, x, x0, x1);
  }
}
#endif  // HISTORY
