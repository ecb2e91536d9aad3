// SPDX-License-Identifier: Apache-2.0
// Variance-guided a-trous filtering (Schied et al. 2017) of direct and indirect illumination, both in one pass for
// they share the geometry's weights.
//   guides: 0 depth (+infinity at invalid pixels)   1..3 unit normal
//   signal: 0..2 direct   3..5 indirect   6, 7 variance of their luminance, as found by a pass over
//   raw: 6, 7 variance of a pixel's own luminance
// SQUARINGS: the exponent of the normals' cosine is 2^SQUARINGS.
// With a history guides plane 4 is its length.

#define LARGEST_VARIANCE 1e36f  // sums of squares stay finite below it

// Exponents of 2 count in units of a float's last bit of its exponent, shifted to where it lies: scales are multiplied
// by it, where they are divided, and cost nothing.
#define EXPONENT_UNIT 8388608.0f  // 2^23

// 2^(t / 2^23) for t <= 0, relative error below 4e-6, below 2e-7 at 0; below 2^-126 denormal or 0, which is the same to
// what comes after. Half a binary digit costs a fifth of the time of the levels, hence not exp2_of_negative. The bits
// of t as a whole number are those of exponent and fraction f; 2^f is a polynomial of degree 4 in m = 1 + f, the best
// one of those that meet it at both ends.
vf exp2_of_bits(vf t) {
  const vf lowest = -127 * EXPONENT_UNIT;
  const vi bits = to_int(t > lowest ? t : lowest);
  const vf m = as_vf((bits & 0x007fffff) | 0x3f800000);
  vf e = 0.0135557475f;
  e = fma(e, m, (vf)-0.00219061994f);
  e = fma(e, m, (vf)0.16661714f);
  e = fma(e, m, (vf)0.312146723f);
  e = fma(e, m, (vf)0.509871006f);
  return as_vf(as_vi(e) + (bits & (int)0xff800000));
}

// Exponents of kB3.
constant float kLogB3[5] = {-4 * EXPONENT_UNIT, -2 * EXPONENT_UNIT, -1.41503750f * EXPONENT_UNIT, -2 * EXPONENT_UNIT,
                            -4 * EXPONENT_UNIT};

// Luminance's standard deviation is at most the sum of the channels' weighted ones (equal if they are fully
// correlated, which a path tracer's nearly are). Squared.
vf luminance_variance(const vf* variance, const vf* albedo) {
  const vf deviation = luminance(sqrt(variance[0]) / albedo[0], sqrt(variance[1]) / albedo[1],
                                 sqrt(variance[2]) / albedo[2]);
  const vf squared = deviation * deviation;
  return squared < (vf)LARGEST_VARIANCE ? squared : (vf)LARGEST_VARIANCE;
}

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict signal, global float* restrict raw, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    vi valid = ordinary(depth) & (depth < (vf)SKY);
    vf light[6], variance[6], albedo[3], normal[3], norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      albedo[c] = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      valid &= ordinary(emission) & ordinary(albedo[c]) & ordinary(normal[c]);
      albedo[c] = albedo_floored(albedo[c]);
      norm = fma(normal[c], normal[c], norm);
    }
    for (int c = 0; c < 6; ++c) {
      light[c] = load_first(in + (IN_DIRECT + c) * area, n, 0.0f);
      variance[c] = load_first(in + (IN_DIRECT_VARIANCE + c) * area, n, 0.0f);
      valid &= ordinary(light[c]) & (variance[c] >= (vf)0.0f) & (variance[c] <= (vf)INFINITY);
      store(valid ? light[c] / albedo[c % 3] : (vf)0.0f, signal + c * plane + p);
    }
    const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
    store(valid ? depth : (vf)INFINITY, guides + p);
    for (int c = 0; c < 3; ++c) store(valid ? normal[c] * scale : (vf)0.0f, guides + (1 + c) * plane + p);
    for (int s = 0; s < 2; ++s)
      store(valid ? luminance_variance(variance + 3 * s, albedo) : (vf)0.0f, raw + (6 + s) * plane + p);
  }
}

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

// EXPONENT_UNIT over the depth difference at which w_z has fallen to 1/2, for the pixels (i, j) * step away on either side.
// reach = sigma_z * step * ln 2.
vf depth_scale(Surface s, int i, int j, float reach) {
  return EXPONENT_UNIT / fma(fabs(fma(s.slope_x, (vf)(float)i, s.slope_y * (float)j)), (vf)reach, s.tolerance);
}

// Of w_z, and of the kernel's weight.
vf depth_exponent(Surface s, global const float* guides, size_t q, vf scale, float kernel_exponent) {
  return fma(-fabs(load(guides + q) - s.z), scale, (vf)kernel_exponent);
}

vf normal_weight(Surface s, global const float* guides, long plane, size_t q) {
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
      const vf w = normal_weight(s, guides, plane, q) * exp2_of_bits(depth_exponent(s, guides, q, scale, 0));
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
      const vf w = normal_weight(s, guides, plane, q) * exp2_of_bits(depth_exponent(s, guides, q, scale, 0));
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

Light light_at(global const float* guides, global const float* light, global const float* variance, int stride,
               long plane, size_t p, float4 k) {
  const float centre = 9.0f / 64;
  Light a;
  a.r = load(light + p);
  a.g = load(light + plane + p);
  a.b = load(light + 2 * plane + p);
  a.scale = EXPONENT_UNIT / fma(sqrt(smoothed_variance(guides, variance, stride, p)), (vf)k.z, (vf)k.w);
  a.sum = centre;
  a.red = a.green = a.blue = 0.0f;
  a.variance = centre * centre * load(variance + p);
  return a;
}

// `weight`: the normals'. `exponent`: of the depths' and the kernel's.
Light gathered(Light a, global const float* light, global const float* variance, long plane, size_t q, vf weight,
               vf exponent) {
  const vf r = load(light + q) - a.r, g = load(light + plane + q) - a.g, b = load(light + 2 * plane + q) - a.b;
  const vf w = weight * exp2_of_bits(fma(fabs(luminance(r, g, b)), -a.scale, exponent));
  a.sum += w;
  a.red = fma(w, r, a.red);
  a.green = fma(w, g, a.green);
  a.blue = fma(w, b, a.blue);
  a.variance = fma(w * w, load(variance + q), a.variance);
  return a;
}

// p plus the mean difference, not the mean: a constant picture comes back bit for bit.
void store_light(Light a, vi valid, global float* light, global float* variance, long plane, size_t p) {
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
    Light direct = light_at(guides, from, from + 6 * plane, stride, plane, p, k);
    Light indirect = light_at(guides, from + 3 * plane, from + 7 * plane, stride, plane, p, k);
    FOR_EACH_CHORD(2, depth_scale(s, i, j, k.x), {
      const vf weight = normal_weight(s, guides, plane, q);
      const vf exponent = depth_exponent(s, guides, q, scale, kLogB3[i + 2] + kLogB3[j + 2]);
      direct = gathered(direct, from, from + 6 * plane, plane, q, weight, exponent);
      indirect = gathered(indirect, from + 3 * plane, from + 7 * plane, plane, q, weight, exponent);
    })
    const vi valid = s.z < (vf)INFINITY;
    store_light(direct, valid, to, to + 6 * plane, plane, p);
    store_light(indirect, valid, to + 3 * plane, to + 7 * plane, plane, p);
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void finish(global const float* restrict input, int w, int h, global const float* restrict guides,
                   global const float* restrict signal, int stride, long plane, long origin, int x0, int y0, int x1,
                   int y1, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    global const float* in = input + (size_t)y * w + x;
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(guides + p) < (vf)INFINITY;
    for (int c = 0; c < 3; ++c) {
      const vf direct = load_first(in + (IN_DIRECT + c) * area, n, 0.0f), indirect = load_first(in + (IN_INDIRECT + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf light = load(signal + c * plane + p) + load(signal + (3 + c) * plane + p);
      const vf color = direct + indirect + emission;
      const vf kept = fabs(color) < (vf)INFINITY ? color : (vf)0.0f;
      store_first(valid ? light * albedo_floored(albedo) + emission : kept,
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
