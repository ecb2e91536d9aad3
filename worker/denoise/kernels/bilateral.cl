// SPDX-License-Identifier: Apache-2.0
// Bilateral filters: Gaussians of distance and colour, and where the filter takes features of these too
// (van de Vlasakker 2013, equations 3.6 to 3.9).
//   strips: 0..2 colour (0 is FAR at invalid pixels)   3 depth   4..6 unit normal   7..9 albedo
// Each plane is scaled so that the weight's exponent falls by the sum of all squared differences.

// k: scales of colour, depth, normal, albedo.
kernel void prepare(WINDOW_INPUT, global float* restrict strips, WINDOW_REGION, float4 k) {
  const int rows = y1 - y0 + 2 * RADIUS;
  const StripRow s = strip_row(get_global_id(1), rows);
  const int y = y0 - RADIUS + s.row;
  const size_t area = (size_t)w * h;
  FOR_EACH_VECTOR(column, 0, PITCH) {
    const int x = x0 + s.strip * STRIP - PAD + column;
    global float* to = strips + strip_offset(s, rows) + column;
    if (y < 0 || y >= h || x <= -VW || x >= w) {
      store_outside(to, FAR);
      continue;
    }
    global const float* in = input + (size_t)y * w;
    vf value[PLANES];
    vi valid = (vi)(-1);
    for (int c = 0; c < 3; ++c) {
      value[c] = load_within(in + (IN_COLOR + c) * area, x, w, INFINITY);
      valid &= ordinary(value[c]);
      value[c] *= k.x;
    }
#ifdef IN_DEPTH
    const vf depth = load_within(in + IN_DEPTH * area, x, w, INFINITY);
    valid &= ordinary(depth) & (depth < (vf)SKY);
    value[3] = depth * k.y;
    vf norm = 0.0f;
    for (int c = 0; c < 3; ++c) {
      value[4 + c] = load_within(in + (IN_N + c) * area, x, w, 0.0f);
      const vf albedo = load_within(in + (IN_ALBEDO + c) * area, x, w, 0.0f);
      valid &= ordinary(value[4 + c]) & ordinary(albedo);
      norm = fma(value[4 + c], value[4 + c], norm);
      value[7 + c] = albedo * k.w;
    }
    const vf scale = norm > (vf)1e-12f ? k.z / sqrt(norm) : (vf)0.0f;
    for (int c = 0; c < 3; ++c) value[4 + c] *= scale;
#endif
    for (int c = 0; c < PLANES; ++c) store(valid ? value[c] : (vf)(c == 0 ? FAR : 0.0f), to + c * PITCH);
  }
}

// output: RGB over [x0, x1) x [y0, y1). Invalid pixels keep their colour. near: EXPONENT_UNIT log2(e) / (2 sigma_s^2);
// unscale: 1 over the colours' scale.
kernel void bilateral(WINDOW_INPUT, global const float* restrict strips, WINDOW_REGION, float near, float unscale,
                      global float* restrict output) {
  const WindowRow r = window_row(x0, y0, x1, y1);
  global const float* centres = strips + r.strip;
  global float* out = output + r.out;
  const size_t area = (size_t)w * h;
  FOR_EACH_VECTOR(column, 0, r.columns) {
    vf centre[PLANES], sum = 0.0f, red = 0.0f, green = 0.0f, blue = 0.0f;
#pragma unroll
    for (int c = 0; c < PLANES; ++c) centre[c] = load(centres + c * PITCH + column);
#pragma nounroll
    for (int j = -RADIUS; j <= RADIUS; ++j) {
      global const float* q = centres + j * (PLANES * PITCH) + column;
      const vf from_row = fma((float)(j * j), -near, OF_ONE);
#pragma unroll
      for (int i = -RADIUS; i <= RADIUS; ++i) {
        const vf r = load(q + i) - centre[0], g = load(q + PITCH + i) - centre[1],
                 b = load(q + 2 * PITCH + i) - centre[2];
        vf exponent = fma(-r, r, from_row + (float)(i * i) * -near);
        exponent = fma(-g, g, exponent);
        exponent = fma(-b, b, exponent);
#pragma unroll
        for (int c = 3; c < PLANES; ++c) {
          const vf feature = load(q + c * PITCH + i) - centre[c];
          exponent = fma(-feature, feature, exponent);
        }
        const vf weight = weight_of(exponent);
        sum += weight;
        red = fma(weight, r, red);
        green = fma(weight, g, green);
        blue = fma(weight, b, blue);
      }
    }
    // The pixel plus the mean difference, not the mean: a constant picture comes back bit for bit.
    const vf scale = unscale / sum, difference[3] = {red, green, blue};
    const vi valid = centre[0] < (vf)(0.5f * FAR);
    for (int c = 0; c < 3; ++c) {
      const int x = x0 + r.first + column;
      const vf color = load_first(input + (IN_COLOR + c) * area + (size_t)r.y * w + x, r.columns - column, 0.0f);
      store_first(filtered_or_kept(valid, fma(difference[c], scale, color), color), out + c * r.area + column,
                  r.columns - column);
    }
  }
}
