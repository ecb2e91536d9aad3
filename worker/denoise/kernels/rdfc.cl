// SPDX-License-Identifier: Apache-2.0
// The three filters of Rousselle et al. 2013 and their errors. Behind rdfc_features.cl.

#define LARGEST_ERROR 1e30f

// A candidate filter on its way over the window: weights, weighted differences from the centre, and what the weights'
// derivatives by the centre's value add to the candidate's.
typedef struct {
  vf weight;
  Rgb sum, slope, sloped;
} Candidate;

#define CANDIDATE_MAPS 10

INLINE Candidate no_candidate() {
  const Rgb none = {0.0f, 0.0f, 0.0f};
  const Candidate a = {0.0f, none, none, none};
  return a;
}

INLINE Candidate candidate_from(global const float* maps, size_t size) {
  const Candidate a = {fetch(maps), load_rgb(maps + size, size), load_rgb(maps + 4 * size, size),
                       load_rgb(maps + 7 * size, size)};
  return a;
}

// Sums of sums round less than one long sum.
INLINE void add_candidate(Candidate a, global float* maps, size_t size) {
  put(fetch(maps) + a.weight, maps);
  add_rgb(a.sum, maps + size, size);
  add_rgb(a.slope, maps + 4 * size, size);
  add_rgb(a.sloped, maps + 7 * size, size);
}

// The neighbour's weight is min(w_c, w_f) = e^-max(d_c, d_f, 0). Where the colours decide, it changes with the
// centre's value by -w d(d_c)/dy. pull: half that derivative, times the patch's values.
INLINE Candidate taken(Candidate a, vf color, vf feature, vf valid, vf count, Rgb difference, Rgb pull) {
  const vf w = weight_of(most_of(color, feature), valid);
  const vi decides = (color > feature) & (color > (vf)0.0f) & (w > (vf)0.0f);
  const vf rate = decides ? w * (-2.0f / (3.0f * count)) : (vf)0.0f;
  const Rgb change = {decides ? rate * pull.r : (vf)0.0f, decides ? rate * pull.g : (vf)0.0f,
                      decides ? rate * pull.b : (vf)0.0f};
  const Rgb finite = {decides ? difference.r : (vf)0.0f, decides ? difference.g : (vf)0.0f,
                      decides ? difference.b : (vf)0.0f};
  a.weight += w;
  a.sum = rgb_fma(rgb_of(w), difference, a.sum);
  a.slope.r += change.r;
  a.slope.g += change.g;
  a.slope.b += change.b;
  a.sloped = rgb_fma(change, finite, a.sloped);
  return a;
}

// Mean distance of a feature of three channels, for both tau.
INLINE void three_channels(global const float* features, global const float* scales, long plane, size_t p, size_t q,
                           vf* distance, vf* strict) {
  vf sum = 0.0f, strict_sum = 0.0f;
#pragma unroll
  for (int f = 0; f < 3; ++f) {
    global const float *feature = features + f * plane, *spread = feature + FEATURES * plane;
    const vf e = excess(fetch(feature + q) - fetch(feature + p), fetch(spread + p), fetch(spread + q));
    sum = fma(e, fetch(scales + f * plane + p), sum);
    strict_sum = fma(e, fetch(scales + (FEATURES + f) * plane + p), strict_sum);
  }
  *distance = sum;
  *strict = strict_sum;
}

// Largest of the features' distances, for both tau.
INLINE void feature_distances(global const float* features, global const float* scales, long plane, size_t p, size_t q,
                              vf* distance, vf* strict) {
  global const float *depth = features + 6 * plane, *spread = depth + FEATURES * plane;
  const vf e = excess(fetch(depth + q) - fetch(depth + p), fetch(spread + p), fetch(spread + q));
  vf albedo, strict_albedo, normal, strict_normal;
  three_channels(features, scales, plane, p, q, &albedo, &strict_albedo);
  three_channels(features + 3 * plane, scales + 3 * plane, plane, p, q, &normal, &strict_normal);
  *distance = most_of(most_of(albedo, normal), e * fetch(scales + 6 * plane + p));
  *strict = most_of(most_of(strict_albedo, strict_normal), e * fetch(scales + (FEATURES + 6) * plane + p));
}

// Half the derivative of the squared difference of pixels p and o by p's value, over what it is divided by.
INLINE Rgb pull_of(Guide g, size_t p, size_t o) {
  const Rgb vp = load_rgb(g.variance + p, g.plane), vo = load_rgb(g.variance + o, g.plane);
  const Rgb d = rgb_minus(load_rgb(g.picture + p, g.plane), load_rgb(g.picture + o, g.plane));
  const Rgb pull = {d.r / fma(vp.r + vo.r, (vf)g.k2, (vf)g.epsilon), d.g / fma(vp.g + vo.g, (vf)g.k2, (vf)g.epsilon),
                    d.b / fma(vp.b + vo.b, (vf)g.k2, (vf)g.epsilon)};
  return pull;
}

// Where the same pixel lies in both patches, its value moves their distance twice: with its own counterpart, and as
// the counterpart of the pixel o on the other side.
INLINE Rgb pulled_twice(Guide g, size_t p, size_t o, Rgb pull) {
  const vi valid = fetch(g.valid + o) > (vf)0.0f;
  const Rgb other = pull_of(g, p, o);
  const Rgb both = {valid ? pull.r + other.r : pull.r, valid ? pull.g + other.g : pull.g,
                    valid ? pull.b + other.b : pull.b};
  return both;
}

// The same window row's next offsets: the distances of small and large patches to each, and the pairs in them.
INLINE void distance_maps(Guide g, Chunk c, Scratch s, int rows, long offset, int count, int plain) {
  const size_t size = chunk_size(rows);
  for (int k = 0; k < count; ++k) {
    global float* maps = s.rest + 4 * k * size;
    pixel_map(g, c, offset + k, 3, 0, s.map, plain ? 0 : s.pairs);
    row_sums(c, 3, 1, s.map, s.sums);
    if (!plain) row_sums(c, 3, 1, s.pairs, s.pair_sums);
    patch_map(c, 3, 1, 3, plain, s.sums, s.pair_sums, maps, maps + 2 * size);
    row_sums(c, 3, 3, s.map, s.sums);
    if (!plain) row_sums(c, 3, 3, s.pairs, s.pair_sums);
    patch_map(c, 3, 3, 3, plain, s.sums, s.pair_sums, maps + size, maps + 3 * size);
  }
}

// One pixel vector and the offsets (i, j), (i + 1, j), ... whose maps are held.
INLINE void gather(Guide g, Scratch s, size_t size, size_t at, size_t p, int i, int j, int count, int plain,
                   global const float* features, global const float* scales) {
  global float *sums = s.rest + 4 * OFFSETS * size + at, *large_sums = sums + CANDIDATE_MAPS * size,
               *feature_sums = large_sums + CANDIDATE_MAPS * size;
  Candidate small = no_candidate(), large = no_candidate(), strictly = no_candidate();
#pragma nounroll
  for (int k = 0; k < count; ++k) {
    const long offset = (long)j * g.stride + i + k;
    const size_t q = p + offset;
    global const float* maps = s.rest + 4 * k * size + at;
    const Rgb difference = rgb_minus(load_rgb(g.picture + q, g.plane), load_rgb(g.picture + p, g.plane));
    const Rgb pull = pull_of(g, p, q);
    const int reach = max(abs(i + k), abs(j));
    Rgb both = pull;
    if (reach <= 3 && reach > 0) both = pulled_twice(g, p, p - offset, pull);
    vf feature, strict;
    feature_distances(features, scales, g.plane, p, q, &feature, &strict);
    const vf valid = fetch(g.valid + q);
    small = taken(small, fetch(maps), feature, valid, plain ? (vf)9.0f : fetch(maps + 2 * size), difference,
                  reach <= 1 ? both : pull);
    large = taken(large, fetch(maps + size), feature, valid, plain ? (vf)49.0f : fetch(maps + 3 * size), difference, both);
    const vf w = weight_of(strict, valid);
    strictly.weight += w;
    strictly.sum = rgb_fma(rgb_of(w), difference, strictly.sum);
  }
  add_candidate(small, sums, size);
  add_candidate(large, large_sums, size);
  put(fetch(feature_sums) + strictly.weight, feature_sums);
  add_rgb(strictly.sum, feature_sums + size, size);
}

// Stein's unbiased estimate of the squared error of y + shift (Rousselle et al. 2013, equation 5), by channel; kept
// finite.
INLINE vf sure(vf shift, vf variance, vf derivative) {
  const vf error = fma(shift, shift, variance * (2.0f * derivative - 1.0f));
  const vf below = error < (vf)LARGEST_ERROR ? error : (vf)LARGEST_ERROR;
  return below > (vf)-LARGEST_ERROR ? below : (vf)-LARGEST_ERROR;
}

INLINE void finish_candidate(Guide g, size_t p, Candidate a, global float* candidate, global float* error) {
  const vi valid = fetch(g.valid + p) > (vf)0.0f;
  const vf scale = 1.0f / a.weight;
  const Rgb y = load_rgb(g.picture + p, g.plane), variance = load_rgb(g.variance + p, g.plane);
  const Rgb shift = {a.sum.r * scale, a.sum.g * scale, a.sum.b * scale};
  const vf total = sure(shift.r, variance.r, (1.0f + a.sloped.r - shift.r * a.slope.r) * scale) +
                   sure(shift.g, variance.g, (1.0f + a.sloped.g - shift.g * a.slope.g) * scale) +
                   sure(shift.b, variance.b, (1.0f + a.sloped.b - shift.b * a.slope.b) * scale);
  const Rgb value = {valid ? y.r + shift.r : (vf)0.0f, valid ? y.g + shift.g : (vf)0.0f,
                     valid ? y.b + shift.b : (vf)0.0f};
  store_rgb(value, candidate + p, g.plane);
  put(valid ? total * (1.0f / 3) : (vf)0.0f, error + p);
}

// The three filters, and their errors. k2: k_c^2.
kernel void rdfc_candidates(global const float* restrict base, global const float* restrict features,
                            global const float* restrict scales, global float* restrict candidates,
                            global float* restrict errors, int stride, long plane, long origin, int x0, int y0, int x1,
                            int y1, int rows, global float* restrict scratch, int window, float k2) {
  if (get_global_id(0) > 0) return;
  const Chunk c = chunk_of(rows, stride, origin, x0, y0, x1, y1);
  const Scratch s = scratch_of(scratch, rows, OWN_MAPS);
  const Guide g = {base, base + plane, base + 4 * plane, plane, stride, 3, k2, 1e-10f, INFINITY};
  const size_t size = chunk_size(rows);
  const int plain = is_plain(base, stride, c, window + 3);
  global float* sums = s.rest + 4 * OFFSETS * size;
  clear(sums, (2 * CANDIDATE_MAPS + 4) * size);
  for (int j = -window; j <= window; ++j)
    for (int i = -window; i <= window; i += OFFSETS) {
      const int count = min(OFFSETS, window + 1 - i);
      distance_maps(g, c, s, rows, (long)j * stride + i, count, plain);
      for (int y = 0; y < c.height; ++y)
        for (int x = 0; x < c.width; x += VW)
          gather(g, s, size, (size_t)y * CHUNK_WIDTH + x, c.origin + (size_t)y * stride + x, i, j, count, plain,
                 features, scales);
    }
  for (int y = 0; y < c.height; ++y)
    for (int x = 0; x < c.width; x += VW) {
      const size_t p = c.origin + (size_t)y * stride + x;
      global const float *small = sums + (size_t)y * CHUNK_WIDTH + x, *large = small + CANDIDATE_MAPS * size,
                         *strict = large + CANDIDATE_MAPS * size;
      const Rgb none = rgb_of((vf)0.0f);
      const Candidate by_features = {fetch(strict), load_rgb(strict + size, size), none, none};
      finish_candidate(g, p, candidate_from(small, size), candidates, errors);
      finish_candidate(g, p, candidate_from(large, size), candidates + 3 * plane, errors + plane);
      finish_candidate(g, p, by_features, candidates + 6 * plane, errors + 2 * plane);
    }
}
