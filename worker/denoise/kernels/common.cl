// SPDX-License-Identifier: Apache-2.0
// What every kernel shares: vectors of VW horizontally neighbouring pixels, padded planes, one exponential.
//
// Planes. A workspace plane holds the tile's outer region at (pad_x, pad_y), surrounded by a pad wider than any
// pass reads. Guide plane 0 is +infinity in the pad and at every pixel that may not be a neighbour (sky, not
// finite): it lies infinitely far away, so that its weight is exactly 0 without a test. The other planes are 0
// there. A result is always stored as 0 where guide plane 0 is infinite, so the pad stays what it is.
//
// No arithmetic depends on where a pixel lies in a vector, a row or a tile: a tile's bits are the frame's.
#pragma OPENCL FP_CONTRACT OFF

// Constants and vectors stay so only inside of what is inlined: a call takes vectors by memory.
#define INLINE __attribute__((always_inline))

#define JOIN2(a, b) a##b
#define JOIN(a, b) JOIN2(a, b)

#if VW == 1
typedef float vf;
typedef int vi;
#define as_vf as_float
#define as_vi as_int
#define to_int(v) convert_int(v)
#define load(p) (*(p))
#define store(v, p) (*(p) = (v))
#else
typedef JOIN(float, VW) vf;
typedef JOIN(int, VW) vi;
#define as_vf JOIN(as_float, VW)
#define as_vi JOIN(as_int, VW)
#define to_int(v) JOIN(convert_int, VW)(v)
#define load(p) JOIN(vload, VW)(0, p)
#define store(v, p) JOIN(vstore, VW)(v, 0, p)
#endif

// A vector at any address of global memory, in one load: the library's vload is pieces to the compiler, which of
// overlapping vectors shares the pieces and puts them together at several times the cost.
#if VW == 1
#define fetch load
#define put store
#else
typedef vf vf_anywhere __attribute__((aligned(4)));
#define fetch(p) (*(global const vf_anywhere*)(p))
#define put(v, p) (*(global vf_anywhere*)(p) = (v))
#endif

// Channels beyond this count as not finite: nothing computed from smaller ones overflows into NaN.
#define LARGEST 1e32f
#define LOG2_E 1.44269504f

// The bicubic B-spline's weights; the kernel is their outer product.
constant float kB3[5] = {1.0f / 16, 1.0f / 4, 3.0f / 8, 1.0f / 4, 1.0f / 16};

// 2^t for t <= 0. Relative error below 3e-7 for t >= -126; exactly 1 at 0; exactly 0 below -126.5 and at
// -infinity. t = n + f with n whole, |f| <= 1/2: 2^n goes into the exponent bits, 2^f is a polynomial of degree 5
// (Chebyshev interpolation of (2^f - 1) / f).
vf exp2_of_negative(vf t) {
  const vf lowest = -127.0f, to_integer = 12583039.0f;  // 1.5 * 2^23 + 127: the sum's low bits are n + 127
  t = t > lowest ? t : lowest;
  const vf shifted = t + to_integer;
  const vf f = t - (shifted - to_integer);
  vf e = 1.33813021e-3f;
  e = fma(e, f, (vf)9.66636837e-3f);
  e = fma(e, f, (vf)5.55038117e-2f);
  e = fma(e, f, (vf)2.40223497e-1f);
  e = fma(e, f, (vf)6.93147182e-1f);
  e = fma(e, f, (vf)1.0f);
  return e * as_vf(as_vi(shifted) << 23);
}

// Exponents of weights may be counted in float's own bits, from that of 1: 2^t has the exponent (t + 127) 2^23. So
// planes are scaled by 2^11.5 more, and an exponent becomes a number by few instructions.
#define OF_ONE 1065353216.0f
#define EXPONENT_UNIT 8388608.0f  // an octave

// The number whose exponent is e, 0 <= e <= OF_ONE. Relative error below 4e-6, and 3e-6 for each rounding of e; exactly
// 1 at OF_ONE and 0 at 0. The mantissa m in [1, 2) becomes 2^(m - 1) by a minimax polynomial of degree 4 that is 1 at 1
// and stays below 2. Two thirds of the cost of exp2_of_negative.
vf number_of(vf e) {
  const vi bits = to_int(e);
  const vf m = as_vf((bits & 0x007fffff) | 0x3f800000);
  vf p = 0.0134266838f;
  p = fma(p, m, (vf)-0.00146426295f);
  p = fma(p, m, (vf)0.165112883f);
  p = fma(p, m, (vf)0.313505113f);
  p = fma(p, m, (vf)0.50941956f);
  const int exponent = 0xff800000;
  return as_vf((as_vi(p) & ~exponent) | (bits & exponent));
}

vf luminance(vf r, vf g, vf b) { return fma((vf)0.2126f, r, fma((vf)0.7152f, g, 0.0722f * b)); }

// 1 (all bits) where |x| is an ordinary number.
vi ordinary(vf x) { return fabs(x) <= (vf)LARGEST; }

// Whether any lane is 1 (all bits).
#if VW == 1
int any_lane(vi lanes) { return lanes; }
#else
// The library's any() is a branch for each lane to the compiler.
int any_lane(vi lanes) {
#if VW == 16
  const long8 pairs = as_long8(lanes);
  return (pairs.s0 | pairs.s1 | pairs.s2 | pairs.s3 | pairs.s4 | pairs.s5 | pairs.s6 | pairs.s7) != 0;
#elif VW == 8
  const long4 pairs = as_long4(lanes);
  return (pairs.s0 | pairs.s1 | pairs.s2 | pairs.s3) != 0;
#else
  return any(lanes);
#endif
}
#endif

// VW floats of a row of which only the first n are ours to read; the others become `rest`.
vf load_first(global const float* p, int n, float rest) {
  if (n >= VW) return fetch(p);
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = k < n ? p[k] : rest;
  return load(lanes);
}

// The same from number i on of a row that has n: those outside are `rest`.
vf load_in_row(global const float* row, int i, int n, float rest) {
  if (i >= 0 && i + VW <= n) return fetch(row + i);
  float lanes[VW];
  for (int k = 0; k < VW; ++k) lanes[k] = i + k >= 0 && i + k < n ? row[i + k] : rest;
  return load(lanes);
}

void store_first(vf v, global float* p, int n) {
  if (n >= VW) {
    put(v, p);
    return;
  }
  float lanes[VW];
  store(v, lanes);
  for (int k = 0; k < n; ++k) p[k] = lanes[k];
}

// What comes of pixels that are not valid: they keep their colour, or are 0 if that is no number.
INLINE vf filtered_or_kept(vi valid, vf filtered, vf color) {
  const vf kept = fabs(color) < (vf)INFINITY ? color : (vf)0.0f;
  return valid ? filtered : kept;
}

// Illumination: what is left of a colour when the surface's albedo is divided out. The floor keeps black surfaces
// finite; the same one is used on the way back.
vf albedo_floored(vf albedo) { return albedo > (vf)1e-3f ? albedo : (vf)1e-3f; }

// Of a kernel that has more vectors than there are registers. Those that go to memory for a while lie there aligned
// only if the whole frame does, which the compiler (LLVM) must know before it finds them: a vector that has to be in
// memory from the beginning tells it. Without, each of them lies across two cache lines.
#if VW == 1
#define ALIGNED_FRAME
#else
#define ALIGNED_FRAME    \
  volatile vf in_memory; \
  in_memory = 0.0f
#endif

// One work-item walks a row, or its share of one, VW pixels at a time.
#define FOR_EACH_VECTOR(x, begin, end) \
  for (int x = (begin) + (int)get_global_id(0) * VW; x < (end); x += (int)get_global_size(0) * VW)

// Rows in an order in which one and the next read mostly the same others: every step-th one, phase after phase.
// `index` runs over step * ceil(rows / step); what comes out may be past the last row.
int row_of(int index, int rows, int step) {
  const int rows_per_phase = (rows + step - 1) / step;
  return index / rows_per_phase + index % rows_per_phase * step;
}
