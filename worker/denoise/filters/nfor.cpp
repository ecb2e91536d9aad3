// SPDX-License-Identifier: Apache-2.0
// NFOR (Bitterli et al. 2016): prefilter the features, two regressions of each half, the better of the two at
// each pixel, a last regression of what came out.
#include <fmt/format.h>

#include "kernels.h"
#include "worker/denoise/filters/patches.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr int kFeatures = 7;
constexpr int kOwnMaps = kOffsets + 85;  // of nfor_fit: distances; sums over a window

class Nfor {
 public:
  explicit Nfor(Stage& stage)
      : s_(stage),
        base_(s_.planes(7)),
        halves_(s_.planes(9)),
        raw_(s_.planes(3 * kFeatures)),
        features_(s_.planes(2 * kFeatures)),
        filtered_(s_.planes(12)),
        coefficients_(s_.planes(30)),
        errors_(s_.planes(3)),
        chunks_(s_, kOwnMaps) {}

  void run() {
    const double unit = s_.plan()["depth_scale"];
    s_.run("prepare", s_.outer(), 1, s_.input(), s_.outer().width(), s_.outer().height(),
           static_cast<float>(unit > 0 ? 1 / unit : 1), base_, halves_, raw_, s_.layout());
    filter_features(0, kFeatures, 2 * kFeatures, 0, 0, 5);
    filter_features(0, 0, 2 * kFeatures, kFeatures, kFeatures, 5);
    int to = 0;
    for (const char* k : {"k_narrow", "k_wide"})
      for (const int half : {0, 1}) {
        const int other = 1 - half;
        regress({halves_, 3 * other}, {halves_, 6}, kFeatures * other, {halves_, 3 * half}, to, k, 1);
        to += 3;
      }
    choose();
    s_.run("nfor_combine", s_.region(0), 1, features_, raw_, s_.layout(), s_.region(0));
    filter_features(4, 0, kFeatures, 0, 0, 2);
    regress({filtered_, 0}, {filtered_, 3}, 0, {filtered_, 0}, 6, "k_final", 5);
    s_.run("finish", s_.inner(), 1, s_.input(), s_.outer().width(), s_.outer().height(), base_, filtered_, 6,
           s_.layout(), Exactly{s_.inner()}, s_.output());
  }

 private:
  struct At {
    const Planes& planes;
    int first;
  };

  int window() const { return static_cast<int>(s_.plan()["window"]); }

  // From planes of raw_ into features_.
  void filter_features(std::size_t pass, int guide, int variance, int from, int to, int window) {
    s_.run("nfor_features", chunks_.over(s_, s_.region(pass)), 1, base_, raw_, guide, variance, from,
           features_, to, s_.layout(), s_.region(pass), chunks_.rows(), chunks_.scratch(), window);
  }

  void regress(At guide, At variance, int features, At picture, int to, const char* k, std::size_t pass) {
    const float k2 = static_cast<float>(s_.plan()[k] * s_.plan()[k]);
    s_.run("nfor_fit", chunks_.over(s_, s_.region(pass)), 1, base_, guide.planes, guide.first,
           variance.planes, variance.first, features_, features, picture.planes, picture.first, coefficients_,
           s_.layout(), s_.region(pass), chunks_.rows(), chunks_.scratch(), window(), k2);
    s_.run("nfor_gather", chunks_.over(s_, s_.region(pass + 1)), 1, base_, guide.planes, guide.first,
           variance.planes, variance.first, features_, features, picture.planes, picture.first, coefficients_,
           filtered_, to, s_.layout(), s_.region(pass + 1), chunks_.rows(), chunks_.scratch(), window(), k2);
  }

  void choose() {
    s_.run("nfor_errors", s_.region(2), 1, base_, halves_, filtered_, errors_, s_.layout(), s_.region(2));
    s_.run("nfor_compare", chunks_.over(s_, s_.region(3)), 1, base_, errors_, s_.layout(), s_.region(3),
           chunks_.rows(), chunks_.scratch(), window());
    s_.run("nfor_blend", chunks_.over(s_, s_.region(4)), 1, base_, errors_, filtered_, s_.layout(),
           s_.region(4), chunks_.rows(), chunks_.scratch(), window());
  }

  Stage& s_;
  const Planes base_, halves_, raw_, features_, filtered_, coefficients_, errors_;
  const Chunks chunks_;
};

void run(Stage& s) { Nfor(s).run(); }

std::string options(const FilterPlan& plan) {
  return fmt::format("-DOWN_MAPS={} -DRIDGE={:e}f -DLEAST_VARIANCE=1e-8f", kOwnMaps, plan["ridge"]);
}

}  // namespace

Program nfor_program() {
  return {"nfor",
          {kernels::patches_cl, kernels::nfor_regression_cl, kernels::nfor_cl, kernels::nfor_select_cl},
          options,
          run};
}

}  // namespace tessera
