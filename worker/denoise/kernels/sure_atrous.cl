// SPDX-License-Identifier: Apache-2.0
// A-trous wavelets whose details come back as far as Stein's unbiased risk estimate allows (Kim et al. 2016).
//   guides: position (three planes) or depth (one; BY_DEPTH); plane 0 is +infinity at invalid pixels.  normal
//   levels: LEVEL_PLANES planes of each level's input, and of what the last one leaves: 0..2 colour
//           3 noise, the sum of the channels' variances, at last the detail's weight   4 variance of luminance
//           (BY_LUMINANCE)
//   details: two planes of each level: the squared detail and its noise, both summed over the channels
// LITERAL: no noise, no details. ON_GRID: weights are multiples of 1/5. WINDOW: radius of the risk's mean.

#define LARGEST_VARIANCE 1e36f  // sums of squares stay finite below it
#define DEPTH_TOLERANCE 6.93147e-4f  // of the depth, times ln 2: keeps iso-depth lines alive

#if BY_DEPTH
#define NORMALS 1
#else
#define NORMALS 3
#endif

vf bounded(vf variance) { return variance < (vf)LARGEST_VARIANCE ? variance : (vf)LARGEST_VARIANCE; }

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict levels, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    vi valid = ordinary(depth) & (depth < (vf)SKY);
    vf color[3], variance[3], normal[3], norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      color[c] = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
#ifdef IN_COLOR_VARIANCE
      variance[c] = load_first(in + (IN_COLOR_VARIANCE + c) * area, n, 0.0f);
#else
      variance[c] = 0.0f;  // is found by sure_variance
#endif
      normal[c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      valid &= ordinary(color[c]) & ordinary(normal[c]) & (variance[c] >= (vf)0.0f) & (variance[c] <= (vf)INFINITY);
      norm = fma(normal[c], normal[c], norm);
    }
#if BY_DEPTH
    store(valid ? depth : (vf)INFINITY, guides + p);
#else
    vf position[3];
    for (int c = 0; c < 3; ++c) {
      position[c] = load_first(in + (IN_P + c) * area, n, 0.0f);
      valid &= ordinary(position[c]);
    }
    for (int c = 0; c < 3; ++c)
      store(valid ? position[c] : (vf)(c == 0 ? INFINITY : 0.0f), guides + c * plane + p);
#endif
    const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
    for (int c = 0; c < 3; ++c) {
      store(valid ? normal[c] * scale : (vf)0.0f, guides + (NORMALS + c) * plane + p);
      store(valid ? color[c] : (vf)0.0f, levels + c * plane + p);
    }
    store(valid ? bounded(variance[0] + variance[1] + variance[2]) : (vf)0.0f, levels + 3 * plane + p);
#if BY_LUMINANCE
    // At most the sum of the channels' weighted deviations, which it is if they are fully correlated.
    const vf deviation = luminance(sqrt(variance[0]), sqrt(variance[1]), sqrt(variance[2]));
    store(valid ? bounded(deviation * deviation) : (vf)0.0f, levels + 4 * plane + p);
#endif
  }
}

// What the geometric weights need of the centre pixel.
typedef struct {
  vf nx, ny, nz;
#if BY_DEPTH
  vf z, slope_x, slope_y, tolerance;
#else
  vf x, y, z, scale;
#endif
} Surface;

// k: y over the squared distance of normals; z over the squared distance of points in footprints, both times
// EXPONENT_UNIT, or z is sigma_z * step * ln 2.
INLINE Surface surface_at(global const float* guides, int stride, long plane, size_t p, float4 k) {
  Surface s;
  s.nx = load(guides + NORMALS * plane + p);
  s.ny = load(guides + (NORMALS + 1) * plane + p);
  s.nz = load(guides + (NORMALS + 2) * plane + p);
#if BY_DEPTH
  s.z = load(guides + p);
  s.slope_x = slope(load(guides + p - 1), s.z, load(guides + p + 1));
  s.slope_y = slope(load(guides + p - stride), s.z, load(guides + p + stride));
  s.tolerance = fma(fabs(s.z), (vf)DEPTH_TOLERANCE, (vf)1e-30f);
#else
  s.x = load(guides + p);
  s.y = load(guides + plane + p);
  s.z = load(guides + 2 * plane + p);
  s.scale = finite_scale(k.z / (squared_footprint(guides, stride, plane, p) + 1e-30f));
#endif
  return s;
}

// Over the distance, for the pixels (i, j) * step away on either side.
INLINE vf distance_scale(Surface s, int i, int j, float4 k) {
#if BY_DEPTH
  return EXPONENT_UNIT / fma(fabs(fma(s.slope_x, (vf)(float)i, s.slope_y * (float)j)), (vf)k.z, s.tolerance);
#else
  return s.scale;
#endif
}

// The exponent of w_n w_x times a weight of the exponent `other`.
INLINE vf exponent_at(Surface s, global const float* guides, long plane, size_t q, vf scale, float4 k, vf other) {
  const vf ax = load(guides + NORMALS * plane + q) - s.nx, ay = load(guides + (NORMALS + 1) * plane + q) - s.ny,
           az = load(guides + (NORMALS + 2) * plane + q) - s.nz;
  const vf normal = fma(fma(ax, ax, fma(ay, ay, az * az)), (vf)-k.y, other);
#if BY_DEPTH
  return fma(-fabs(load(guides + q) - s.z), scale, normal);
#else
  const vf x = load(guides + q) - s.x, y = load(guides + plane + q) - s.y, z = load(guides + 2 * plane + q) - s.z;
  return fma(fma(x, x, fma(y, y, z * z)), -scale, normal);
#endif
}

// Differences of light whose squares stay finite.
INLINE vf square_bounded(vf d) {
  d = d < (vf)1e18f ? d : (vf)1e18f;
  return d > (vf)-1e18f ? d : (vf)-1e18f;
}

// The noise by the 7x7 picture around, where the samples do not tell: moments about the centre, which do not
// cancel.
kernel void sure_variance(global const float* restrict guides, global float* restrict levels, int stride, long plane,
                          long origin, int x0, int y0, int x1, int y1, float4 k) {
  const int y = y0 + get_global_id(1), step = 1;
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k);
    const vf r = load(levels + p), g = load(levels + plane + p), b = load(levels + 2 * plane + p);
    vf sum = 1.0f, red = 0.0f, green = 0.0f, blue = 0.0f, squares = 0.0f, light = 0.0f;
    FOR_EACH_CHORD(3, distance_scale(s, i, j, k), {
      const vf w = weight_of(exponent_at(s, guides, plane, q, scale, k, OF_ONE));
      const vf cr = square_bounded(load(levels + q) - r);
      const vf cg = square_bounded(load(levels + plane + q) - g);
      const vf cb = square_bounded(load(levels + 2 * plane + q) - b);
      sum += w;
      red = fma(w, cr, red);
      green = fma(w, cg, green);
      blue = fma(w, cb, blue);
      squares = fma(w, fma(cr, cr, fma(cg, cg, cb * cb)), squares);
      const vf l = luminance(cr, cg, cb);
      light = fma(w, l * l, light);
    })
    const vf scale = 1.0f / sum;
    const vi valid = load(guides + p) < (vf)INFINITY;
    red *= scale, green *= scale, blue *= scale;
    const vf noise = fma(squares, scale, -fma(red, red, fma(green, green, blue * blue)));
    store(valid & (noise > (vf)0.0f) ? noise : (vf)0.0f, levels + 3 * plane + p);
#if BY_LUMINANCE
    const vf mean = luminance(red, green, blue), variance = fma(light, scale, -mean * mean);
    store(valid & (variance > (vf)0.0f) ? variance : (vf)0.0f, levels + 4 * plane + p);
#endif
  }
}

// EXPONENT_UNIT over the illumination's difference (squared, or of luminance) at which its weight has fallen to 1/2.
INLINE vf light_scale(global const float* guides, global const float* levels, global const float* from, int stride,
               long plane, size_t p, float4 k) {
#if BY_LUMINANCE
  return EXPONENT_UNIT / fma(sqrt(smoothed_variance(guides, from + 4 * plane, stride, p)), (vf)k.x, (vf)k.w);
#else
  return k.x / (load(levels + 3 * plane + p) + 1e-20f);  // of the samples, whatever the level
#endif
}

// correction: the true variance of a detail of white noise over what the propagated one comes to, where nothing
// stops the filter: what the levels before have correlated.
kernel void sure_level(global const float* restrict guides, global float* restrict levels,
                       global float* restrict details, int stride, long plane, long origin, int x0, int y0, int x1,
                       int y1, int step, int level, float correction, float4 k) {
  ALIGNED_FRAME;
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  const float centre = 9.0f / 64;
  global const float* restrict from = levels + LEVEL_PLANES * level * plane;
  global float* restrict to = levels + LEVEL_PLANES * (level + 1) * plane;
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const Surface s = surface_at(guides, stride, plane, p, k);
    const vf r = load(from + p), g = load(from + plane + p), b = load(from + 2 * plane + p);
    const vf stop = light_scale(guides, levels, from, stride, plane, p, k);
    vf others = 0.0f, red = 0.0f, green = 0.0f, blue = 0.0f, noise = 0.0f, variance = 0.0f;
    FOR_EACH_CHORD(2, distance_scale(s, i, j, k), {
      const vf cr = load(from + q) - r;
      const vf cg = load(from + plane + q) - g;
      const vf cb = load(from + 2 * plane + q) - b;
      const vf light = BY_LUMINANCE ? fabs(luminance(cr, cg, cb)) : fma(cr, cr, fma(cg, cg, cb * cb));
      const vf others_exponent = exponent_at(s, guides, plane, q, scale, k, OF_ONE + kLogB3[i + 2] + kLogB3[j + 2]);
      const vf w = weight_of(fma(light, -stop, others_exponent));
      others += w;
      red = fma(w, cr, red);
      green = fma(w, cg, green);
      blue = fma(w, cb, blue);
      if (!LITERAL) noise = fma(w * w, load(from + 3 * plane + q), noise);
      if (BY_LUMINANCE) variance = fma(w * w, load(from + 4 * plane + q), variance);
    })
    // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
    const vf scale = 1.0f / (others + centre);
    const vi valid = load(guides + p) < (vf)INFINITY;
    red *= scale, green *= scale, blue *= scale;
    store(valid ? r + red : (vf)0.0f, to + p);
    store(valid ? g + green : (vf)0.0f, to + plane + p);
    store(valid ? b + blue : (vf)0.0f, to + 2 * plane + p);
#if !LITERAL
    const vf own = load(from + 3 * plane + p), squared = scale * scale;
    store(valid ? fma((vf)(centre * centre), own, noise) * squared : (vf)0.0f, to + 3 * plane + p);
    store(valid ? fma(red, red, fma(green, green, blue * blue)) : (vf)0.0f, details + 2 * level * plane + p);
    store(valid ? fma(others * others, own, noise) * squared * correction : (vf)0.0f,
          details + (2 * level + 1) * plane + p);
#endif
#if BY_LUMINANCE
    store(valid ? fma((vf)(centre * centre), load(from + 4 * plane + p), variance) * scale * scale : (vf)0.0f,
          to + 4 * plane + p);
#endif
  }
}

// The w in [0, 1] of least risk (w - 1)^2 d^2 + (2 w - 1) noise of a level's detail, the risk's mean taken over the
// window. Where there is no picture both are 0. It takes the place of the level's noise, which nobody reads any more.
// Row after row in the level's own order: in the picture's, the rows of a wide window would be fetched anew for each.
kernel void sure_weights(global const float* restrict guides, global float* restrict levels,
                         global const float* restrict details, int stride, long plane, long origin, int x0, int y0,
                         int x1, int y1, int step, int level) {
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  global const float* restrict detail = details + 2 * level * plane;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    vf squares = 0.0f, noise = 0.0f;
#pragma nounroll
    for (int j = -WINDOW; j <= WINDOW; ++j) {
#pragma unroll
      for (int i = -WINDOW; i <= WINDOW; ++i) {
        const size_t q = p + (long)(j * step) * stride + i * step;
        squares += load(detail + q);
        noise += load(detail + plane + q);
      }
    }
    const vi valid = load(guides + p) < (vf)INFINITY;
    vf w = squares > noise ? 1.0f - noise / squares : (vf)0.0f;
    if (ON_GRID) w = rint(5.0f * w) * 0.2f;  // the risk is a parabola: the nearest point is the best
    store(valid ? w : (vf)0.0f, levels + (LEVEL_PLANES * (long)level + 3) * plane + p);
  }
}

// output: RGB over the pixels [x0, x1) x [y0, y1) of the outer region. Invalid pixels keep their colour.
kernel void sure_reconstruct(global const float* restrict input, int w, int h, global const float* restrict guides,
                             global const float* restrict levels, int stride, long plane, long origin, int x0, int y0,
                             int x1, int y1, int count, global float* restrict output) {
  const int row = get_global_id(1), y = y0 + row;
  const size_t area = (size_t)w * h, out_area = (size_t)(x1 - x0) * (y1 - y0);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const int n = x1 - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vi valid = load(guides + p) < (vf)INFINITY;
    vf coarse[3], result[3];
    for (int c = 0; c < 3; ++c)
      result[c] = coarse[c] = load(levels + (LEVEL_PLANES * (long)count + c) * plane + p);
    for (int level = count; level-- > 0;) {
#if LITERAL
      const vf weight = 0.2f;
#else
      const vf weight = load(levels + (LEVEL_PLANES * (long)level + 3) * plane + p);
#endif
      for (int c = 0; c < 3; ++c) {
        const vf fine = load(levels + (LEVEL_PLANES * (long)level + c) * plane + p);
        result[c] = fma(weight, fine - coarse[c], result[c]);
        coarse[c] = fine;
      }
    }
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)y * w + x, n, 0.0f);
      const vf positive = result[c] > (vf)0.0f ? result[c] : (vf)0.0f;
      store_first(filtered_or_kept(valid, positive, color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
