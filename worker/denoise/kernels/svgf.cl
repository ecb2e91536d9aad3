// SPDX-License-Identifier: Apache-2.0
// Variance-guided a-trous filtering (Schied et al. 2017) of direct and indirect illumination, both in one pass for
// they share the geometry's weights.
//   guides: 0 depth (+infinity at invalid pixels)   1..3 unit normal
//   signal: 0..2 direct   3..5 indirect   6, 7 variance of their luminance, as found by a pass over
//   raw: 6, 7 variance of a pixel's own luminance; with MOMENTS, where the picture tells it, the luminance itself
// SQUARINGS: the exponent of the normals' cosine is 2^SQUARINGS.
// With a history guides plane 4 is its length.

// What the geometric weights need of the centre pixel.
typedef struct {
  vf z, nx, ny, nz;
  vf slope_x, slope_y;  // depth per pixel of the local plane
  vf tolerance;         // of depth, beyond the plane: keeps iso-depth lines, where the plane allows none, alive
} Surface;

Surface surface_at(global const float* guides, int stride, long plane, size_t p, float tolerance) {
  Surface s;
  s.z = load(guides + p);
  s.nx = load(guides + plane + p);
  s.ny = load(guides + 2 * plane + p);
  s.nz = load(guides + 3 * plane + p);
  s.slope_x = slope(load(guides + p - 1), s.z, load(guides + p + 1));
  s.slope_y = slope(load(guides + p - stride), s.z, load(guides + p + stride));
  s.tolerance = fma(fabs(s.z), (vf)tolerance, (vf)1e-30f);
  return s;
}

// EXPONENT_UNIT over the depth difference at which w_z has fallen to 1/2, for the pixels (i, j) * step away on either
// side.
// reach = sigma_z * step * ln 2.
vf depth_scale(Surface s, int i, int j, float reach) {
  return EXPONENT_UNIT / fma(fabs(fma(s.slope_x, (vf)(float)i, s.slope_y * (float)j)), (vf)reach, s.tolerance);
}

#define STEEP (SQUARINGS >= 7)

// A weight is `factor` times the number whose exponent is `exponent`.
typedef struct {
  vf exponent;
#if !STEEP
  vf factor;
#endif
} Likeness;

// w_n in an exponent, where it is steep: with t = 1 - cos, ln cos = -(t + t^2/2 + t^3/3) - t^4/4 - ... Of the power
// k = 2^SQUARINGS what is left out takes less than k t^4/4 exp(-kt) from a weight of 1, at most (4/k)^3 e^-4: 6e-7.
#define STEEPNESS (LOG2_E * EXPONENT_UNIT * (1 << SQUARINGS))

// Of w_z times w_n times a weight of the exponent `other`.
INLINE Likeness likeness(Surface s, global const float* guides, long plane, size_t q, vf scale, float other) {
  const vf nx = load(guides + plane + q), ny = load(guides + 2 * plane + q), nz = load(guides + 3 * plane + q);
  Likeness a;
  a.exponent = other;
#if STEEP
  const vf t = fma(-s.nx, nx, fma(-s.ny, ny, fma(-s.nz, nz, (vf)1.0f)));
  const vf series = fma(fma(t, (vf)(-STEEPNESS / 3), (vf)(-STEEPNESS / 2)), t, (vf)-STEEPNESS);
  a.exponent = fma(series, t, a.exponent);
#else
  const vf cosine = fma(s.nx, nx, fma(s.ny, ny, s.nz * nz));
  a.factor = cosine > (vf)0.0f ? cosine : (vf)0.0f;
#pragma unroll
  for (int k = 0; k < SQUARINGS; ++k) a.factor *= a.factor;
#endif
  a.exponent = fma(-fabs(load(guides + q) - s.z), scale, a.exponent);
  return a;
}

INLINE vf weight(Likeness a, vf exponent) {
#if STEEP
  return weight_of(exponent);
#else
  return a.factor * weight_of(exponent);
#endif
}

INLINE vf geometry_weight(Surface s, global const float* guides, long plane, size_t q, vf scale) {
  const Likeness a = likeness(s, guides, plane, q, scale, OF_ONE);
  return weight(a, a.exponent);
}

// The arguments that every pass takes. k: sigma_z * step * ln 2, depth tolerance * ln 2, sigma_l * ln 2,
// luminance tolerance * ln 2.
#define PASS_ARGUMENTS                                                                                          \
  global const float *restrict guides, global const float *restrict from, global float *restrict to, int stride, \
      long plane, long origin, int x0, int y0, int x1, int y1, int step, float4 k

// The samples' variances, averaged over the surface around. from: raw; to: the signal, of which nothing else changes.
kernel void svgf_variance_samples(PASS_ARGUMENTS) {
  ALIGNED_FRAME;
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k.y);
    vf sum = 1.0f, direct = load(from + 6 * plane + p), indirect = load(from + 7 * plane + p);
    FOR_EACH_CHORD(3, depth_scale(s, i, j, k.x), {
      const vf w = geometry_weight(s, guides, plane, q, scale);
      sum += w;
      direct = fma(w, load(from + 6 * plane + q), direct);
      indirect = fma(w, load(from + 7 * plane + q), indirect);
    })
    const vi valid = s.z < (vf)INFINITY;
    store(valid ? direct / sum : (vf)0.0f, to + 6 * plane + p);
    store(valid ? indirect / sum : (vf)0.0f, to + 7 * plane + p);
  }
}

// Kept where its square is finite.
vf bounded_step(vf d) {
  d = d < (vf)1e18f ? d : (vf)1e18f;
  return d > (vf)-1e18f ? d : (vf)-1e18f;
}

vf variance_of(vf sum, vf first, vf second) {
  const vf mean = first / sum, v = second / sum - mean * mean;
  return v > (vf)0.0f ? v : (vf)0.0f;
}

// The variance of the picture over the surface around (Schied et al. 2017, section 4.2), by moments about the
// centre's luminance: they do not cancel. from: raw; to: the signal, of which nothing else changes.
kernel void svgf_variance_spatial(PASS_ARGUMENTS) {
  ALIGNED_FRAME;
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k.y);
    const vi valid = s.z < (vf)INFINITY;
#ifdef HISTORY
    // Where the history is long enough, its own variance stays.
    const vi young = valid & (load(guides + 4 * plane + p) < (vf)4.0f);
    if (!any_lane(young)) continue;
#else
    const vi young = valid;
#endif
    const vf direct0 = load(from + 6 * plane + p), indirect0 = load(from + 7 * plane + p);
    vf sum = 1.0f, direct1 = 0.0f, direct2 = 0.0f, indirect1 = 0.0f, indirect2 = 0.0f;
    FOR_EACH_CHORD(3, depth_scale(s, i, j, k.x), {
      const vf w = geometry_weight(s, guides, plane, q, scale);
      const vf direct = bounded_step(load(from + 6 * plane + q) - direct0);
      const vf indirect = bounded_step(load(from + 7 * plane + q) - indirect0);
      sum += w;
      direct1 = fma(w, direct, direct1);
      direct2 = fma(w, direct * direct, direct2);
      indirect1 = fma(w, indirect, indirect1);
      indirect2 = fma(w, indirect * indirect, indirect2);
    })
#ifdef HISTORY
    const vf old_direct = load(to + 6 * plane + p), old_indirect = load(to + 7 * plane + p);
#else
    const vf old_direct = 0.0f, old_indirect = 0.0f;
#endif
    store(young ? variance_of(sum, direct1, direct2) : old_direct, to + 6 * plane + p);
    store(young ? variance_of(sum, indirect1, indirect2) : old_indirect, to + 7 * plane + p);
  }
}

// One kind of light on its way through a level.
typedef struct {
  vf r, g, b;                          // at the centre
  vf scale;                            // EXPONENT_UNIT over the luminance difference at which w_l has fallen to 1/2
  vf sum, red, green, blue, variance;  // of the weights, the weighted differences, the variance
} Light;

// Of the planes of a signal, those of direct light (0) or indirect (1).
typedef struct {
  global const float *light, *variance;
} Source;
INLINE Source source_of(global const float* signal, long plane, int kind) {
  const Source a = {signal + 3 * kind * plane, signal + (6 + kind) * plane};
  return a;
}

// The light at p. scale: see there.
INLINE Light light_at(Source from, long plane, size_t p, vf scale) {
  const float centre = 9.0f / 64;
  Light a;
  a.r = load(from.light + p);
  a.g = load(from.light + plane + p);
  a.b = load(from.light + 2 * plane + p);
  a.scale = scale;
  a.sum = centre;
  a.red = a.green = a.blue = 0.0f;
  a.variance = centre * centre * load(from.variance + p);
  return a;
}

// The scales of both lights. Their variances are smoothed by the 3x3 Gaussian (1/4, 1/2, 1/4)^2 over the valid pixels,
// which steers and is not passed on.
INLINE void find_scales(global const float* guides, global const float* variance, int stride, long plane, size_t p,
                        float4 k, vf* scales) {
  vf sum = 0.0f, direct = 0.0f, indirect = 0.0f;
#pragma unroll
  for (int j = -1; j <= 1; ++j) {
#pragma unroll
    for (int i = -1; i <= 1; ++i) {
      const size_t q = p + (long)j * stride + i;
      const vf g = load(guides + q) < (vf)INFINITY ? (vf)((i ? 0.25f : 0.5f) * (j ? 0.25f : 0.5f)) : (vf)0.0f;
      sum += g;
      direct = fma(g, load(variance + q), direct);
      indirect = fma(g, load(variance + plane + q), indirect);
    }
  }
  const vf inverse = 1.0f / sum;
  scales[0] = EXPONENT_UNIT / fma(sqrt(direct * inverse), (vf)k.z, (vf)k.w);
  scales[1] = EXPONENT_UNIT / fma(sqrt(indirect * inverse), (vf)k.z, (vf)k.w);
}

// What the pixels at q add, as far as they are like those at p.
INLINE void gather(Light* a, Source from, long plane, size_t q, Likeness like) {
  const vf r = load(from.light + q) - a->r, g = load(from.light + plane + q) - a->g,
           b = load(from.light + 2 * plane + q) - a->b;
  const vf w = weight(like, fma(fabs(luminance(r, g, b)), -a->scale, like.exponent));
  a->sum += w;
  a->red = fma(w, r, a->red);
  a->green = fma(w, g, a->green);
  a->blue = fma(w, b, a->blue);
  a->variance = fma(w * w, load(from.variance + q), a->variance);
}

#define TAPS 24

// The light at p with all that its window adds. taps: their distances from p.
INLINE Light gathered(Source from, long plane, size_t p, vf scale, const long* taps, const Likeness* like) {
  Light a = light_at(from, plane, p, scale);
#pragma nounroll
  for (int n = 0; n < TAPS; ++n) gather(&a, from, plane, p + taps[n], like[n]);
  return a;
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
INLINE void filtered_light(const Light* a, vi valid, vf* rgb) {
  const vf scale = 1.0f / a->sum;
  rgb[0] = valid ? fma(a->red, scale, a->r) : (vf)0.0f;
  rgb[1] = valid ? fma(a->green, scale, a->g) : (vf)0.0f;
  rgb[2] = valid ? fma(a->blue, scale, a->b) : (vf)0.0f;
}

INLINE vf filtered_variance(const Light* a, vi valid) {
  const vf scale = 1.0f / a->sum;
  return valid ? a->variance * scale * scale : (vf)0.0f;
}

// Both kinds of light once they have passed a level, direct first.
typedef struct {
  vi valid;
  vf light[6], variance[2];
} Passed;

INLINE Passed passed_at(global const float* guides, global const float* from, int stride, long plane, size_t p, int step,
                        float4 k) {
  const Surface s = surface_at(guides, stride, plane, p, k.y);
  vf scales[2];
  find_scales(guides, from + 6 * plane, stride, plane, p, k, scales);
  // The geometry and both lights have a loop each, for together they take more registers than there are.
  Likeness like[TAPS];
  long taps[TAPS];
  int n = 0;
  FOR_EACH_CHORD(2, depth_scale(s, i, j, k.x), {
    taps[n] = (long)q - (long)p;
    like[n++] = likeness(s, guides, plane, q, scale, OF_ONE + kLogB3[i + 2] + kLogB3[j + 2]);
  })
  const Light direct = gathered(source_of(from, plane, 0), plane, p, scales[0], taps, like);
  const Light indirect = gathered(source_of(from, plane, 1), plane, p, scales[1], taps, like);
  Passed a;
  a.valid = s.z < (vf)INFINITY;
  filtered_light(&direct, a.valid, a.light);
  filtered_light(&indirect, a.valid, a.light + 3);
  a.variance[0] = filtered_variance(&direct, a.valid);
  a.variance[1] = filtered_variance(&indirect, a.valid);
  return a;
}

// kept: whether the light is, too.
kernel void svgf_level(PASS_ARGUMENTS, KEPT_ARGUMENTS) {
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Passed a = passed_at(guides, from, stride, plane, p, step, k);
#pragma unroll
    for (int c = 0; c < 6; ++c) store(a.light[c], to + c * plane + p);
#pragma unroll
    for (int c = 0; c < 2; ++c) store(a.variance[c], to + (6 + c) * plane + p);
    keep_light(a.light, kept, kept_x0, kept_y0, kept_x1, kept_y1, output, x, y);
  }
}

// The last one makes the picture. to: RGB over the pixels [px0, px1) x [py0, py1) of the outer region.
kernel void svgf_last_level(PASS_ARGUMENTS, KEPT_ARGUMENTS, global const float* restrict input, int w, int h, int px0,
                            int py0, int px1, int py1) {
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  const size_t area = (size_t)(px1 - px0) * (py1 - py0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const Passed a = passed_at(guides, from, stride, plane, origin + (size_t)y * stride + x, step, k);
    keep_light(a.light, kept, kept_x0, kept_y0, kept_x1, kept_y1, output, x, y);
    vf rgb[3];
    modulated(input + (size_t)y * w + x, (size_t)w * h, w - x, a.valid, a.light, rgb);
    global float* out = to + (size_t)(y - py0) * (px1 - px0) + (x - px0);
#pragma unroll
    for (int c = 0; c < 3; ++c) store_between(rgb[c], out + c * area, x, px0, px1);
  }
}
