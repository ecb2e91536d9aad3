// SPDX-License-Identifier: Apache-2.0
// Variance-guided a-trous filtering (Schied et al. 2017) of direct and indirect illumination, both in one pass for
// they share the geometry's weights.
//   guides: 0 depth (+infinity at invalid pixels)   1..3 unit normal
//   signal: 0..2 direct   3..5 indirect   6, 7 variance of their luminance, as found by a pass over
//   raw: 6, 7 variance of a pixel's own luminance
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

// Of w_z times a weight of the exponent `other`.
INLINE vf depth_exponent(Surface s, global const float* guides, size_t q, vf scale, float other) {
  return fma(-fabs(load(guides + q) - s.z), scale, (vf)other);
}

INLINE vf normal_weight(Surface s, global const float* guides, long plane, size_t q) {
  const vf nx = load(guides + plane + q), ny = load(guides + 2 * plane + q), nz = load(guides + 3 * plane + q);
  vf w = fma(s.nx, nx, fma(s.ny, ny, s.nz * nz));
  w = w > (vf)0.0f ? w : (vf)0.0f;
#pragma unroll
  for (int k = 0; k < SQUARINGS; ++k) w *= w;
  return w;
}

// The arguments that every pass takes. k: sigma_z * step * ln 2, depth tolerance * ln 2, sigma_l * ln 2,
// luminance tolerance * ln 2.
#define PASS_ARGUMENTS                                                                                          \
  global const float *restrict guides, global const float *restrict from, global float *restrict to, int stride, \
      long plane, long origin, int x0, int y0, int x1, int y1, int step, float4 k

// The samples' variances, averaged over the surface around. from: raw; to: the signal, of which nothing else changes.
kernel void svgf_variance_samples(PASS_ARGUMENTS) {
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k.y);
    vf sum = 1.0f, direct = load(from + 6 * plane + p), indirect = load(from + 7 * plane + p);
    FOR_EACH_CHORD(3, depth_scale(s, i, j, k.x), {
      const vf w = normal_weight(s, guides, plane, q) * weight_of(depth_exponent(s, guides, q, scale, OF_ONE));
      sum += w;
      direct = fma(w, load(from + 6 * plane + q), direct);
      indirect = fma(w, load(from + 7 * plane + q), indirect);
    })
    const vi valid = s.z < (vf)INFINITY;
    store(valid ? direct / sum : (vf)0.0f, to + 6 * plane + p);
    store(valid ? indirect / sum : (vf)0.0f, to + 7 * plane + p);
  }
}

// Luminance of the light at q minus that at p, kept where its square is finite.
vf luminance_step(global const float* light, long plane, size_t p, size_t q) {
  vf d = luminance(load(light + q) - load(light + p), load(light + plane + q) - load(light + plane + p),
                   load(light + 2 * plane + q) - load(light + 2 * plane + p));
  d = d < (vf)1e18f ? d : (vf)1e18f;
  return d > (vf)-1e18f ? d : (vf)-1e18f;
}

vf variance_of(vf sum, vf first, vf second) {
  const vf mean = first / sum, v = second / sum - mean * mean;
  return v > (vf)0.0f ? v : (vf)0.0f;
}

// The variance of the picture over the surface around (Schied et al. 2017, section 4.2), by moments about the
// centre's luminance: they do not cancel. to: the signal, of which nothing else changes.
kernel void svgf_variance_spatial(PASS_ARGUMENTS) {
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
    vf sum = 1.0f, direct1 = 0.0f, direct2 = 0.0f, indirect1 = 0.0f, indirect2 = 0.0f;
    FOR_EACH_CHORD(3, depth_scale(s, i, j, k.x), {
      const vf w = normal_weight(s, guides, plane, q) * weight_of(depth_exponent(s, guides, q, scale, OF_ONE));
      const vf direct = luminance_step(to, plane, p, q);
      const vf indirect = luminance_step(to + 3 * plane, plane, p, q);
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

// The light at p. scale: see there.
INLINE Light light_at(global const float* light, global const float* variance, long plane, size_t p, vf scale) {
  const float centre = 9.0f / 64;
  Light a;
  a.r = load(light + p);
  a.g = load(light + plane + p);
  a.b = load(light + 2 * plane + p);
  a.scale = scale;
  a.sum = centre;
  a.red = a.green = a.blue = 0.0f;
  a.variance = centre * centre * load(variance + p);
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

// `normal`: the normals' weight. `exponent`: of the depths' and the kernel's.
INLINE void gather(Light* a, global const float* light, global const float* variance, long plane, size_t q, vf normal,
                   vf exponent) {
  const vf r = load(light + q) - a->r, g = load(light + plane + q) - a->g, b = load(light + 2 * plane + q) - a->b;
  const vf w = normal * weight_of(fma(fabs(luminance(r, g, b)), -a->scale, exponent));
  a->sum += w;
  a->red = fma(w, r, a->red);
  a->green = fma(w, g, a->green);
  a->blue = fma(w, b, a->blue);
  a->variance = fma(w * w, load(variance + q), a->variance);
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
INLINE void store_light(Light a, vi valid, global float* light, global float* variance, long plane, size_t p) {
  const vf scale = 1.0f / a.sum;
  store(valid ? fma(a.red, scale, a.r) : (vf)0.0f, light + p);
  store(valid ? fma(a.green, scale, a.g) : (vf)0.0f, light + plane + p);
  store(valid ? fma(a.blue, scale, a.b) : (vf)0.0f, light + 2 * plane + p);
  store(valid ? a.variance * scale * scale : (vf)0.0f, variance + p);
}

kernel void svgf_level(PASS_ARGUMENTS) {
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k.y);
    vf scales[2];
    find_scales(guides, from + 6 * plane, stride, plane, p, k, scales);
    Light direct = light_at(from, from + 6 * plane, plane, p, scales[0]);
    Light indirect = light_at(from + 3 * plane, from + 7 * plane, plane, p, scales[1]);
    FOR_EACH_CHORD(2, depth_scale(s, i, j, k.x), {
      const vf normal = normal_weight(s, guides, plane, q);
      const vf exponent = depth_exponent(s, guides, q, scale, OF_ONE + kLogB3[i + 2] + kLogB3[j + 2]);
      gather(&direct, from, from + 6 * plane, plane, q, normal, exponent);
      gather(&indirect, from + 3 * plane, from + 7 * plane, plane, q, normal, exponent);
    })
    const vi valid = s.z < (vf)INFINITY;
    store_light(direct, valid, to, to + 6 * plane, plane, p);
    store_light(indirect, valid, to + 3 * plane, to + 7 * plane, plane, p);
  }
}
