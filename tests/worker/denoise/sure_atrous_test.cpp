// SPDX-License-Identifier: Apache-2.0
// What SURE-based a-trous wavelets promise.
#include <cmath>
#include <random>
#include <string>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

constexpr float kDeviation = 0.1f, kLight = 2;

class SureAtrous : public OnDevice {
 protected:
  // A flat wall of white noise about kLight, of known variance.
  static Image wall(const FilterPlan& plan, const Region& region, float stated_variance,
                    unsigned seed = 2016) {
    Image input = made_up_input(plan, region, "constant");
    std::mt19937 random(seed);
    std::normal_distribution<float> noise(kLight, kDeviation);
    const std::vector<Channel> inputs = plan.inputs();
    for (int k = 0; k < input.planes(); ++k)
      for (int y = region.y0; y < region.y1; ++y)
        for (int x = region.x0; x < region.x1; ++x) input.at(k, x, y) = value(inputs[k], x, y);
    for (int c = 0; c < 3; ++c)
      for (float& v : input.plane(plane_of(plan, Aov::color, c))) v = noise(random);
    for (int k = 0; k < input.planes(); ++k)
      if (inputs[k].statistic == Statistic::variance_of_mean) std::ranges::fill(input.plane(k), stated_variance);
    return input;
  }
  static float value(const Channel& c, int x, int y) {
    if (c.aov == Aov::position)
      return c.index == 0 ? static_cast<float>(x) : c.index == 1 ? static_cast<float>(y) : 4;
    if (c.aov == Aov::depth) return 4;
    return c.aov == Aov::normal && c.index == 2 ? 1 : 0;
  }
  static std::string levels(std::string_view filter, int n) {
    return std::string(filter) + "levels=" + std::to_string(n);
  }
};

// Of values about `mean`, in the middle of a picture.
double deviation(const Image& image, double mean, int border) {
  const Region r = grown(image.region(), -border);
  double squares = 0;
  for (int k = 0; k < 3; ++k)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) squares += std::pow(image.at(k, x, y) - mean, 2);
  return std::sqrt(squares / (3.0 * static_cast<double>(r.area())));
}

Image operator-(Image a, const Image& b) {
  for (std::size_t i = 0; i < a.data().size(); ++i) a.data()[i] -= b.data()[i];
  return a;
}

// Where the variance is stated to be vast, nothing but the surface stops the filter and no detail is kept:
// what comes out is what the levels leave.
constexpr float kVast = 1e12f;

TEST_F(SureAtrous, DetailsAndWhatIsLeftAddUpToThePicture) {
  // C_5 with all details kept by a variance of 0 is C_0; with none kept it is what EAW leaves without an edge
  // stop in the colour, which knows nothing of details. C_0 - C_5 is thus the sum of the details.
  const FilterPlan sure = parse_filter("sure-atrous"), eaw = parse_filter("atrous:sigma_c=1e4");
  const Region region{0, 0, 150, 140};
  const Image kept = filtered(sure, wall(sure, region, 0)), input = wall(sure, region, kVast);
  const Image left = filtered(sure, input);
  Image other = wall(sure, region, kVast);
  Image of_eaw(region, static_cast<int>(eaw.inputs().size()));
  for (int k = 0; k < of_eaw.planes(); ++k) {
    const Channel c = eaw.inputs()[k];
    if (c.aov == Aov::albedo) std::ranges::fill(of_eaw.plane(k), 1.0f);
    if (c.aov == Aov::albedo || c.aov == Aov::emission) continue;
    std::ranges::copy(other.plane(plane_of(sure, c.aov, c.index)), of_eaw.plane(k).begin());
  }
  const Image expected = filtered(eaw, of_eaw);
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < left.plane(k).size(); ++i) {
      ASSERT_NEAR(left.plane(k)[i], expected.plane(k)[i], 1e-6 * kLight);
      ASSERT_NEAR(kept.plane(k)[i], input.plane(plane_of(sure, Aov::color, k))[i], 1e-6 * kLight);
    }
}

TEST_F(SureAtrous, DetailsOfWhiteNoiseHaveTheDeviationsOfTheTable) {
  // Of the spectra of the chained B3 kernels, as the filter states them.
  constexpr double expected[] = {0.89080, 0.20066, 0.08551, 0.04122, 0.02042};
  const Region region{0, 0, 512, 512};
  Image finer;
  for (int level = 0; level < 5; ++level) {
    const FilterPlan plan = parse_filter(levels("sure-atrous:sigma_x=1e4,", level + 1));
    const Image input = wall(plan, region, kVast);
    if (level == 0) finer = cropped(input, region);
    const Image coarser = filtered(plan, input);
    Image fine(region, 3);
    for (int k = 0; k < 3; ++k)
      std::ranges::copy(finer.plane(level == 0 ? plane_of(plan, Aov::color, k) : k), fine.plane(k).begin());
    // A detail is correlated over some 2^level pixels: of a third as many squares of independent values the
    // root deviates by 1 / sqrt(2 count).
    const double count = 3 * 512.0 * 512 / std::pow(4, level) / 3;
    EXPECT_NEAR(deviation(fine - coarser, 0, 62) / kDeviation / expected[level], 1,
                std::max(0.01, 4 / std::sqrt(2 * count)))
        << level;
    finer = coarser;
  }
}

TEST_F(SureAtrous, NoiseOfKnownVarianceIsTakenOutAndWhatIsMoreIsKept) {
  const FilterPlan plan = parse_filter("sure-atrous:edge=svgf");
  const Region region{0, 0, 200, 200};
  const double noise = deviation(filtered(plan, wall(plan, region, kDeviation * kDeviation)), kLight, 40);
  EXPECT_LT(noise, 0.15 * kDeviation);
  // Stated a hundred times smaller than it is, the same noise is taken for detail.
  const double detail =
      deviation(filtered(plan, wall(plan, region, 1e-4f * kDeviation * kDeviation)), kLight, 40);
  EXPECT_GT(detail, 0.9 * kDeviation);
}

TEST_F(SureAtrous, TheValidRiskLeavesLessNoiseThanThePrintedOne) {
  const Region region{0, 0, 200, 200};
  for (const std::string edge : {"paper", "svgf"}) {
    const FilterPlan valid = parse_filter("sure-atrous:edge=" + edge),
                     literal = parse_filter("sure-atrous:mode=literal,edge=" + edge);
    const float variance = kDeviation * kDeviation;
    EXPECT_LT(deviation(filtered(valid, wall(valid, region, variance)), kLight, 40),
              0.95 * deviation(filtered(literal, wall(literal, region, variance)), kLight, 40))
        << edge;
  }
}

TEST_F(SureAtrous, ThePrintedRiskTakesAFifthOfEveryDetail) {
  const FilterPlan literal = parse_filter("sure-atrous:mode=literal"), valid = parse_filter("sure-atrous");
  const Region region{0, 0, 100, 100};
  const Image input = wall(valid, region, kVast);
  const Image left = filtered(valid, input), result = filtered(literal, input);
  for (int k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < left.plane(k).size(); ++i) {
      const float noisy = input.plane(plane_of(valid, Aov::color, k))[i];
      ASSERT_NEAR(result.plane(k)[i], 0.2f * noisy + 0.8f * left.plane(k)[i], 2e-6 * kLight);
    }
}

TEST_F(SureAtrous, NeverYieldsLessThanNothing) {
  const FilterPlan plan = parse_filter("sure-atrous:mode=literal");
  Image input = wall(plan, {0, 0, 60, 60}, kVast);
  // A dark line: rounding and the negative light that some renderers yield.
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 60; ++y) input.at(plane_of(plan, Aov::color, c), 30, y) = -40;
  const Image result = filtered(plan, input);
  EXPECT_EQ(result.at(0, 30, 30), 0.0f);
  for (const float v : result.data()) ASSERT_GE(v, 0.0f);
}

TEST_F(SureAtrous, WithASingleSampleTheVarianceIsThatOfThePicture) {
  // No variance in a single sample, which is stated as 0 and leaves the picture as it is.
  const FilterPlan samples = parse_filter("sure-atrous:edge=svgf"),
                   spatial = parse_filter("sure-atrous:edge=svgf,variance=spatial");
  const Region region{0, 0, 200, 200};
  EXPECT_NEAR(deviation(filtered(samples, wall(samples, region, 0)), kLight, 40), kDeviation,
              0.01 * kDeviation);
  EXPECT_LT(deviation(filtered(spatial, wall(spatial, region, 0)), kLight, 40), 0.2 * kDeviation);
}

}  // namespace
}  // namespace tessera
