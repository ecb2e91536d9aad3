// SPDX-License-Identifier: Apache-2.0
// Non-local means: of two halves that filter one another (Rousselle et al. 2012), and the form by which
// Lardinoije's Feature Distance Filter smooths its feature.
#include "core/filter/nlm.h"

#include "core/filter/descriptions.h"

namespace tessera {
namespace {

constexpr double dual = 0, prefilter = 1;           // choices of `mode`
constexpr double mean_of_exp = 0, exp_of_mean = 1;  // of `patch_mode`

constexpr std::string_view kDual = "Rousselle et al. 2012, section 4";

std::vector<Parameter> parameters() {
  return {
      {"mode",
       "two halves of the samples, each with the weights of the other; or each colour channel for itself",
       "",
       "Rousselle et al. 2012; Lardinoije, section 4.2",
       dual,
       prefilter,
       dual,
       true,
       {"dual", "prefilter"}},
      {"radius", "of the window; 0: the mode's own, 10 of dual and 5 of prefilter", "pixels",
       "Rousselle et al. 2012, section 6; Lardinoije, section 4.2", 0, 20, 0, true},
      {"patch", "radius of the patches that are compared; 0: the mode's own, 3 of dual and 2 of prefilter",
       "pixels", "Rousselle et al. 2012, section 6; Lardinoije, section 4.2", 0, 5, 0, true},
      {"patch_mode",
       "what a patch of the prefilter weighs: the mean of its pixels' exponentials, or the exponential of "
       "their"
       " mean distance, as in dual",
       "",
       "Lardinoije, section 4.2; Rousselle et al. 2012, section 4",
       mean_of_exp,
       exp_of_mean,
       mean_of_exp,
       true,
       {"mean_of_exp", "exp_of_mean"}},
      {"k", "damping: distance, in standard deviations, that stops the filter; not of mean_of_exp", "1",
       kDual, 0.1, 10, 0.45},
      {"alpha", "how much of the distance that noise makes is taken off; not of mean_of_exp", "1", kDual,
       0.01, 4, 1},
      {"threshold", "weights below count as 0; not of mean_of_exp", "1", kDual, 0, 0.5, 0.05},
      {"cut",
       "how weights end at the threshold: hard, as in the source, or lowered by it; not of mean_of_exp",
       "",
       kDual,
       0,
       1,
       0,
       true,
       {"hard", "soft"}},
      {"epsilon", "variance that every pixel has at least", "radiance squared",
       "Rousselle et al. 2012, equation 3; Lardinoije, section 4.2", 1e-12, 1, 1e-10},
  };
}

bool by_exponentials(const ParameterValues& v) {
  return v.find("mode")->second == prefilter && v.find("patch_mode")->second == mean_of_exp;
}

std::vector<Channel> inputs(const ParameterValues& v) {
  std::vector<Channel> all;
  if (v.find("mode")->second == dual) {
    for (const Share half : {Share::a, Share::b})
      for (const Statistic s : {Statistic::mean, Statistic::variance_of_mean})
        append(all, {Aov::color}, s, half);
  } else {
    append(all, {Aov::color});
    append(all, {Aov::color}, Statistic::variance_of_mean);
    all.push_back(kSampleCount);
  }
  return all;
}

std::vector<Pass> passes(const ParameterValues& v) {
  const NlmShape s = nlm_shape(v);
  const int images = 3 / s.channels;
  const double floats = 1 + images * s.halves * s.channels * 3;
  if (by_exponentials(v))
    return {{"nlm_mean_of_exp", 1, s.reach(), images * nlm_mean_of_exp_flops(s), floats}};
  return {{"nlm", 1, s.reach(), images * nlm_flops(s), floats}};
}

double scratch(const ParameterValues& v) {
  const NlmShape s = nlm_shape(v);
  return 1 + 9.0 * s.halves + nlm_scratch(s);
}

}  // namespace

NlmShape nlm_shape(const ParameterValues& v) {
  const bool halves = v.find("mode")->second == dual;
  const int radius = static_cast<int>(v.find("radius")->second),
            patch = static_cast<int>(v.find("patch")->second);
  return {.radius = radius > 0 ? radius
                    : halves   ? 10
                               : 5,
          .patch = patch > 0 ? patch
                   : halves  ? 3
                             : 2,
          .channels = halves ? 3 : 1,
          .halves = halves ? 2 : 1};
}

// Numbers are of one offset; what a pair of pixels shares counts half. Down a column as many rows as the
// patch's radius are summed first.
double nlm_flops(const NlmShape& s) {
  const double reciprocals = s.halves == 2 ? 3 + 1 : 1;
  const double distance = 0.5 * s.channels * (reciprocals + s.halves * (1 + 1 + 1 + 3 * 2)) + s.halves;
  const double sums = (s.patch + 1) + 2.0 * s.patch;
  return s.offsets() * (distance + s.halves * (sums + 2 + 1 + kNumberFlops + 1 + 1 + 3 * s.channels));
}

double nlm_mean_of_exp_flops(const NlmShape& s) {
  const double pair = 1 + 1 + 1 + 1 + 1 + kNumberFlops + (s.patch + 1) + 2.0 * s.patch;
  return s.offsets() * (0.5 * pair + 1 + 1 + 2);
}

// A table row is longer than the tile's by what offsets and patches reach, and by the rest of a vector.
double nlm_scratch(const NlmShape& s) {
  constexpr double kVector = 16;
  const double longer = (kNlmColumns + 2.0 * s.patch + s.radius + kNlmGroup + kVector) / kNlmColumns;
  const double higher = (kNlmRows + 1.0 * s.radius) / kNlmRows, beside = 1.0 * kNlmRowsBeside / kNlmRows;
  const double wider = (kNlmColumns + 2.0 * s.reach() + kNlmGroup + 2 * kVector) / kNlmColumns;
  const double taller = (kNlmRows + 2.0 * s.reach()) / kNlmRows;
  return kUneven * (s.halves * (s.channels + 1) + nlm_planes(s) * wider * taller +
                    kNlmGroup * longer * ((2 * s.halves + 1) * higher + beside));
}

FilterDescription describe_nlm() {
  return {
      .name = "nlm",
      .summary = "non-local means: pixels whose surroundings look alike are averaged; takes colour alone",
      .source =
          "F. Rousselle, C. Knaus, M. Zwicker: Adaptive Rendering with Non-Local Means Filtering, SIGGRAPH"
          " Asia 2012; M. Lardinoije: High-quality interactive path tracing, Utrecht University",
      .parameters = parameters(),
      .inputs = inputs,
      .passes = passes,
      .scratch = scratch};
}

}  // namespace tessera
