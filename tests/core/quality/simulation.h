// SPDX-License-Identifier: Apache-2.0
// A renderer and two denoisers in miniature, with a known true image: what the error estimates and the stop
// rule are calibrated on. Noise is hit-or-miss with exponential values, as of path tracing with small lights.
#pragma once

#include <random>
#include <vector>

#include "core/acceptance.h"
#include "core/film.h"
#include "core/quality/estimate.h"

namespace tessera::simulation {

// Radiance of a sample of a pixel: with probability `hit_rate`, truth / hit_rate times an exponential
// variable of mean 1; else 0.
struct Fireflies {
  double rate = 0;  // of the samples
  float value = 0;  // added to such a sample
};
struct World {
  Image truth;     // RGB, without fireflies
  Image expected;  // RGB, with them
  Image albedo;    // RGB, what a filter may look at
  Image hit_rate;  // 1 plane
  Fireflies fireflies;
};

// Ramps, edges, texture that the albedo shows and texture that it hides, a dark corner beside a lamp, soft
// shadows; hit rates from 2 to 60 %. Varies with `seed`.
World make_world(Size size, unsigned seed, const Fireflies& = {});

// Film sums of a world, growing by samples [have, want) of the pixels of a region.
class Renderer {
 public:
  Renderer(World world, unsigned seed);
  const World& world() const { return world_; }
  const FilmLayout& layout() const { return layout_; }
  const Image& sums() const { return sums_; }
  void render(const Region& region, int samples);  // adds; half to A, half to B

 private:
  World world_;
  FilmLayout layout_;
  Image sums_;
  std::mt19937 random_;
};

// Means 0..2 and variances of the mean 3..5 of one half.
Image half_of(const Image& sums, const FilmLayout& layout, Part part);

// Denoised RGB of an image of half_of. Both weigh by the very noise they filter.
enum class Denoiser { none, bilateral, atrous };
Image denoised(Denoiser, const Image& half, const Image& albedo);

// What the estimates see of a render: the halves, noisy and denoised, and Y.
struct Look {
  Look(const Renderer&, Denoiser);
  HalfImages halves() const { return {a, b, x_a, x_b}; }
  Image a, b, x_a, x_b, y;
};

// Mean relMSE of `x` over a region of the world.
double true_error(const Image& x, const Image& truth, const Region& region);

// What the stop rule made of a world, or of several.
struct Outcome {
  double cells = 0, accepted = 0;
  double violations = 0, violations_of_y = 0;  // accepted cells whose delivered image, or Y, is above target
  double error = 0;                            // sum of relMSE of the accepted cells, delivered image
  double samples = 0;                          // per pixel, summed over cells
  double samples_alone = 0;                    // without those taken for a neighbour's sake
  double oracle_samples = 0;  // of the first uniform look at which Y of a cell is below target
  Outcome& operator+=(const Outcome&);
};

enum class RuleVariant { naive, no_guards, full };  // naive: the first look with T below the target

Outcome run_rule(Size, unsigned seed, Denoiser, double target, const Fireflies&, RuleVariant);

}  // namespace tessera::simulation
