// SPDX-License-Identifier: Apache-2.0
// The synthesis: what the windows' models say of each pixel; with a history, mixed with what they said before (Koskela
// et al. 2019, section 3.5), and kept; then the albedo.

// What is kept of a pixel for the next frame, in the order of these planes, the light that was filtered last.
//   kept: planes of bmfr_accumulate at the pixel. Over [x0, x1) x [y0, y1) of the outer region.
#if TEMPORAL
INLINE void keep_pixel(const vf* in, vf object, const Pixel* s, const vf* kept, const vf* filtered, global float* out, size_t area,
                int x, int x0, int x1) {
#pragma unroll
  for (int c = 0; c < 4; ++c) store_between(c < COUNT ? kept[c] * UP : kept[c], out + c * area, x, x0, x1);
#pragma unroll
  for (int c = 0; c < 3; ++c) {
    store_between(s->valid ? in[IN_N + c] : (vf)0.0f, out + (KEPT_NORMAL + c) * area, x, x0, x1);
    store_between(s->valid ? in[IN_P + c] : (vf)0.0f, out + (KEPT_POSITION + c) * area, x, x0, x1);
    store_between(s->valid ? filtered[c] : (vf)0.0f, out + (KEPT_FILTERED + c) * area, x, x0, x1);
  }
#if OBJECTS
  store_between(s->valid ? in[IN_DEPTH] : (vf)0.0f, out + KEPT_DEPTH * area, x, x0, x1);
  store_between(s->valid ? object : (vf)0.0f, out + KEPT_OBJECT * area, x, x0, x1);
#endif
}
#endif

// picture: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour. Cell (0, 0)
// starts at `lattice`.xy and has the parities `odd`. accumulated: planes of bmfr_accumulate over the outer region.
// output, over [ix0, ix1) x [iy0, iy1): the history from plane 3 on.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict accumulated,
                   global const float* restrict models, int stride, long plane, int4 lattice, int2 odd, float alpha,
                   int x0, int y0, int x1, int y1, global float* restrict picture, int ix0, int iy0, int ix1, int iy1,
                   global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, picture_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  const int j = (y - lattice.y) / CELL, first = (x0 - lattice.x) / CELL, last = (x1 - 1 - lattice.x) / CELL;
  for (int i = first + (int)get_global_id(0); i <= last; i += (int)get_global_size(0)) {
    const int left = lattice.x + i * CELL, end = min(left + CELL, x1);
    for (int x = max(left, x0); x < end; x += VW) {
      global const float* at = input + (size_t)y * w + x;
      vf in[CHANNELS], light[3], material = 0.0f;
#pragma unroll
      for (int c = 0; c < CHANNELS; ++c) in[c] = load_first(at + c * area, w - x, 0.0f);
#if MATERIAL
      material = load_first(at + IN_MATERIALID * area, w - x, 0.0f);
#endif
      const Pixel s = pixel_of(in, material);
      synthesised(models, stride, plane, odd, i, j, left, (y - lattice.y) % CELL, x, &s, light);
#if TEMPORAL
      vf kept[ACCUMULATED], object = 0.0f;
#pragma unroll
      for (int c = 0; c < ACCUMULATED; ++c)
        kept[c] = load_first(accumulated + c * area + (size_t)y * w + x, w - x, 0.0f);
      mix_in_filtered(kept, alpha, light);
#if OBJECTS
      object = load_first(at + IN_OBJECTID * area, w - x, 0.0f);
#endif
      if (y >= iy0 && y < iy1)
        keep_pixel(in, object, &s, kept, light,
                   output + 3 * (size_t)(ix1 - ix0) * (iy1 - iy0) + (size_t)(y - iy0) * (ix1 - ix0) + (x - ix0),
                   (size_t)(ix1 - ix0) * (iy1 - iy0), x, ix0, min(end, ix1));
#endif
#pragma unroll
      for (int c = 0; c < 3; ++c) {
        const vf lit = light[c] * albedo_floored(in[IN_ALBEDO + c]) + in[IN_EMISSION + c];
        store_first(filtered_or_kept(s.valid, lit, in[IN_COLOR + c]),
                    picture + c * picture_area + (size_t)row * (x1 - x0) + (x - x0), end - x);
      }
    }
  }
}
