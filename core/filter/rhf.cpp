// SPDX-License-Identifier: Apache-2.0
// Ray Histogram Fusion: pixels whose samples' histograms agree are averaged.
#include "core/filter/rhf.h"

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr double of_pixels = 0, of_patches = 1;  // choices of `average`

std::vector<Parameter> parameters() {
  return {
      {"radius", "of the window that is searched", "pixels",
       "Delbracio et al. 2014, published implementation (b); Lardinoije names none", 1, 10, 6, true},
      {"patch", "half-width of the patches that are compared; 0: pixel with pixel", "pixels",
       "Delbracio et al. 2014, published implementation (w)", 0, 3, 1, true},
      {"threshold", "chi-square distance per bin from which on pixels differ", "1",
       "Lardinoije, section 4.1, leaves it to the user; 0.8 in benchmarks of the published implementation",
       1e-3, 1e3, 0.8},
      {"scales",
       "at which the picture is filtered, each half as fine as the one before: the coarser ones take the low"
       " frequencies' noise",
       "",
       "1: Lardinoije, section 4.1; Delbracio et al. 2014 filter several, 2 in the published implementation",
       1, RhfScale::most, 1, true},
      {"average",
       "what is averaged: the pixels that agree, or whole patches, of which a pixel takes the mean of all "
       "that"
       " cover it",
       "",
       "pixels: Lardinoije, section 4.1; patches: Delbracio et al. 2014",
       of_pixels,
       of_patches,
       of_pixels,
       true,
       {"pixels", "patches"}},
      {"bins",
       "which bins of two pixels are compared: those with a sample, or those with more than one sample",
       "",
       "filled: Lardinoije, section 4.1; shared: Delbracio et al. 2014, published implementation",
       0,
       1,
       0,
       true,
       {"filled", "shared"}},
      {"gate",
       "if not 0: pixels also differ where a channel of albedo does by 0.03 times this, or of the normal "
       "mapped"
       " to 0..1 by 0.06 times this",
       "1", "Lardinoije, section 4.1 (albedo and normals beside histograms), scales of its section 4.2", 0,
       100, 0},
  };
}

std::vector<Channel> inputs(const ParameterValues& values) {
  std::vector<Channel> all;
  append(all, {Aov::color, Aov::depth, Aov::histogram});
  all.push_back(kSampleCount);
  if (values.find("gate")->second > 0) append(all, {Aov::albedo, Aov::normal});
  return all;
}

struct Shape {
  int radius, patch, scales;
  bool patches, shared, gate;
  RhfScale coarsest() const { return {scales - 1}; }
  double pixels() const { return scales == 1 ? 1 : scales == 2 ? 1.25 : 1.3125; }  // of all scales, of one
  int pairs() const { return radius + radius * (2 * radius + 1); }  // the later half of the window
};

Shape shape(const ParameterValues& values) {
  const auto of = [&](std::string_view name) { return values.find(name)->second; };
  return {static_cast<int>(of("radius")),
          static_cast<int>(of("patch")),
          static_cast<int>(of("scales")),
          of("average") == of_patches,
          of("bins") > 0,
          of("gate") > 0};
}

// Of a pixel of the picture: its share of making a coarser scale's. Columns, then rows of what is left.
Pass decimation(const Shape& s) {
  const double planes = 2 + 3 + 3 * kHistogramBins + (s.gate ? 6 : 0);
  Pass all{"rhf_decimate", 1, s.coarsest().low_pass(), 0, 0};
  for (int level = 1; level < s.scales; ++level) {
    const RhfScale scale{level};
    const double step = scale.step(), taps = 2 * scale.low_pass() + 1;
    all.flops += planes * (3 * taps / step + 2 * taps / (step * step));
    all.floats += planes * (1 + 1 / (step * step));
  }
  return all;
}

// From each scale to the next finer one. A pixel in four lies on the coarser grid, two lie between pixels of
// a row or column of it, one amid four.
Pass merging(const Shape& s) {
  const double taps = (1 + 4 + 4 + 16) / 4.0, low_pass = 7 * 7 / 4.0;
  return {"rhf_merge", 1, RhfScale::interpolation * (s.coarsest().step() - 1),
          s.pixels() * 3 * 2 * (taps + low_pass), s.pixels() * (4 + 3 + 3 * 2 / 4.0)};
}

// The pairs' distances are symmetric: half of the window is enough. The pass reads `radius` further than its
// region only for pairs that reach out of it, which nobody asks for: what both pixels of a pair lie in is
// counted with the passes that take the pairs. Of several scales, the coarsest reaches furthest: it is made,
// filtered, and merged into one after another.
std::vector<Pass> passes(const ParameterValues& values) {
  const Shape s = shape(values);
  const double bins = 3 * kHistogramBins;
  const double four = 4 * (1 + 2 + 1) + 2 * 4 + 4 + 11 + 2 + (s.shared ? 4 * 3 : 0);  // of four bins
  const double pair = bins / 4 * four + 12 + 4 * s.patch + (s.gate ? 18 : 0);
  const int step = s.coarsest().step();
  const double n = s.pixels();
  std::vector<Pass> all;
  if (s.scales > 1) all.push_back(decimation(s));
  all.push_back({"rhf_compare", 1, step * s.patch, n * s.pairs() * pair, n * (bins + 3 + s.radius + 1)});
  if (s.patches) all.push_back({"rhf_count", 1, step * s.radius, n * 2 * s.pairs(), n * (s.radius + 2)});
  all.push_back({"rhf_average", 1, step * (s.patches ? s.patch : s.radius),
                 n * 2 * s.pairs() * (s.patches ? 10 + (2 * s.patch + 1) * (2 * s.patch + 1) : 10),
                 n * (s.radius + 1 + 3 + 3)});
  if (s.scales > 1) all.push_back(merging(s));
  return all;
}

double scratch(const ParameterValues& values) {
  // The smallest tile's planes have this many floats, and one block's working memory.
  constexpr double kSmallestPlane = 2500;
  const Shape s = shape(values);
  const double planes = (s.gate ? 7.0 : 1.0) + 6 + (s.radius + 1) + (s.patches ? 1 : 0);
  double all = planes + RhfBlock{s.radius, s.patch}.floats() / kSmallestPlane;
  if (s.scales == 1) return all;
  // Each scale's filtered light, and of a coarser one its input and what is merged; the pads of a small
  // picture's coarser planes are as large as its own.
  all += 3;
  for (int level = 1; level < s.scales; ++level)
    all += planes + (static_cast<double>(inputs(values).size()) + 3 + 3) / (1 << 2 * level);
  return all;
}

}  // namespace

FilterDescription describe_rhf() {
  return {.name = "rhf",
          .summary = "averages pixels whose samples have like histograms",
          .source =
              "M. Delbracio, P. Muse, A. Buades, J. Chauvier, N. Phelps, J.-M. Morel: Boosting Monte Carlo"
              " Rendering by Ray Histogram Fusion, ACM TOG 33(1), 2014, as read by M. Lardinoije:"
              " High-quality interactive path tracing, MSc thesis, Utrecht",
          .parameters = parameters(),
          .inputs = inputs,
          .passes = passes,
          .scratch = scratch};
}

}  // namespace tessera
