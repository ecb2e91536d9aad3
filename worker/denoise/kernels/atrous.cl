// SPDX-License-Identifier: Apache-2.0
// The edge-avoiding a-trous wavelet transform (Dammertz et al. 2010) on demodulated colour.
//   guides: 0..2 position (0 is +infinity at invalid pixels)   3..5 normal      signal: 0..2 illumination

kernel void prepare(global const float* restrict input, int w, int h, global float* restrict guides,
                    global float* restrict signal, int stride, long plane, long origin) {
  const int y = get_global_id(1);
  const size_t area = (size_t)w * h;
  if (y >= h) return;
  FOR_EACH_VECTOR(x, 0, w) {
    global const float* in = input + (size_t)y * w + x;
    const int n = w - x;
    const size_t p = origin + (size_t)y * stride + x;
    const vf depth = load_first(in + IN_DEPTH * area, n, INFINITY);
    vi valid = ordinary(depth) & (depth < (vf)SKY);
    vf illumination[3], guide[6], norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      const vf color = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      valid &= ordinary(color) & ordinary(emission) & ordinary(albedo);
      illumination[c] = (color - emission) / albedo_floored(albedo);
      guide[c] = load_first(in + (IN_P + c) * area, n, 0.0f);
      guide[3 + c] = load_first(in + (IN_N + c) * area, n, 0.0f);
      valid &= ordinary(guide[c]) & ordinary(guide[3 + c]);
      norm = fma(guide[3 + c], guide[3 + c], norm);
    }
    const vf scale = norm > (vf)1e-12f ? 1.0f / sqrt(norm) : (vf)0.0f;
    for (int c = 0; c < 3; ++c) {
      store(valid ? illumination[c] : (vf)0.0f, signal + c * plane + p);
      store(valid ? guide[c] : (vf)(c == 0 ? INFINITY : 0.0f), guides + c * plane + p);
      store(valid ? guide[3 + c] * scale : (vf)0.0f, guides + (3 + c) * plane + p);
    }
  }
}

// k: log2(e) EXPONENT_UNIT over the squared sigmas of this level: illumination, normal, position in footprints.
kernel void atrous_level(global const float* restrict guides, global const float* restrict from,
                         global float* restrict to, int stride, long plane, long origin, int x0, int y0, int x1,
                         int y1, int step, float4 k) {
  ALIGNED_FRAME;
  const int y = y0 + row_of(get_global_id(1), y1 - y0, step);
  if (y >= y1) return;
  FOR_EACH_VECTOR(x, x0, x1) {
    const size_t p = origin + (size_t)y * stride + x;
    const vf px = load(guides + p), py = load(guides + plane + p), pz = load(guides + 2 * plane + p);
    const vf nx = load(guides + 3 * plane + p), ny = load(guides + 4 * plane + p),
             nz = load(guides + 5 * plane + p);
    const vf r = load(from + p), g = load(from + plane + p), b = load(from + 2 * plane + p);
    const vf kx = finite_scale(k.z / (squared_footprint(guides, stride, plane, p) + 1e-30f));
    vf sum = kB3[2] * kB3[2], dr = 0.0f, dg = 0.0f, db = 0.0f;
#pragma nounroll
    for (int j = -2; j <= 2; ++j) {
#pragma unroll
      for (int i = -2; i <= 2; ++i) {
        if (i == 0 && j == 0) continue;
        const size_t q = p + (long)(j * step) * stride + i * step;
        const vf cr = load(from + q) - r, cg = load(from + plane + q) - g, cb = load(from + 2 * plane + q) - b;
        const vf ax = load(guides + 3 * plane + q) - nx, ay = load(guides + 4 * plane + q) - ny,
                 az = load(guides + 5 * plane + q) - nz;
        const vf bx = load(guides + q) - px, by = load(guides + plane + q) - py, bz = load(guides + 2 * plane + q) - pz;
        const vf color = fma(cr, cr, fma(cg, cg, cb * cb));
        const vf normal = fma(ax, ax, fma(ay, ay, az * az));
        const vf position = fma(bx, bx, fma(by, by, bz * bz));
        const vf exponent = OF_ONE + kLogB3[i + 2] + kLogB3[j + 2];
        const vf weight = weight_of(fma(position, -kx, fma(normal, (vf)-k.y, fma(color, (vf)-k.x, exponent))));
        sum += weight;
        dr = fma(weight, cr, dr);
        dg = fma(weight, cg, dg);
        db = fma(weight, cb, db);
      }
    }
    // p plus the mean difference, not the mean: a constant picture comes back bit for bit.
    const vf scale = 1.0f / sum;
    const vi valid = px < (vf)INFINITY;
    store(valid ? fma(dr, scale, r) : (vf)0.0f, to + p);
    store(valid ? fma(dg, scale, g) : (vf)0.0f, to + plane + p);
    store(valid ? fma(db, scale, b) : (vf)0.0f, to + 2 * plane + p);
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
      const vf color = load_first(in + (IN_COLOR + c) * area, n, 0.0f);
      const vf emission = load_first(in + (IN_EMISSION + c) * area, n, 0.0f);
      const vf albedo = load_first(in + (IN_ALBEDO + c) * area, n, 0.0f);
      const vf filtered = load(signal + c * plane + p) * albedo_floored(albedo) + emission;
      store_first(filtered_or_kept(valid, filtered, color),
                  output + c * out_area + (size_t)row * (x1 - x0) + (x - x0), n);
    }
  }
}
