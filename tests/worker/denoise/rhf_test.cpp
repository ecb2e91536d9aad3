// SPDX-License-Identifier: Apache-2.0
// What is true of Ray Histogram Fusion (Delbracio et al. 2014).
#include <cmath>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

// Which bin of each channel holds how many of a pixel's samples.
struct Samples {
  float n = 16;
  std::vector<std::pair<int, float>> bins;
};

class Rhf : public OnDevice {
 protected:
  // A picture of one row, each pixel as bright as its place in it.
  Image row(const FilterPlan& plan, const std::vector<Samples>& pixels) {
    Image input = made_up_input(plan, {0, 0, static_cast<int>(pixels.size()), 1}, "constant");
    for (int x = 0; x < input.region().width(); ++x) {
      const Samples& s = pixels[x];
      for (int c = 0; c < 3; ++c) {
        input.at(plane_of(plan, Aov::color, c), x, 0) = static_cast<float>(x);
        for (int b = 0; b < kHistogramBins; ++b)
          input.at(plane_of(plan, Aov::histogram, c * kHistogramBins + b), x, 0) = 0;
        for (const auto& [bin, count] : s.bins)
          input.at(plane_of(plan, Aov::histogram, c * kHistogramBins + bin), x, 0) = count / s.n;
      }
      input.at(plane_of(plan, Aov::color, 0, Statistic::samples), x, 0) = s.n;
    }
    return input;
  }
  // Whether two pixels are merged: the black one then is the mean of both.
  bool merged(std::string_view text, const Samples& a, const Samples& b) {
    const FilterPlan plan = parse_filter(text);
    const Image result = filtered(plan, row(plan, {a, b}));
    EXPECT_TRUE(result.at(0, 0, 0) == 0 || result.at(0, 0, 0) == 0.5f) << result.at(0, 0, 0);
    EXPECT_EQ(result.at(0, 0, 0), 1 - result.at(0, 1, 0)) << "merging is mutual";
    return result.at(0, 0, 0) == 0.5f;
  }
  // Merged from a threshold on that lies above `distance`.
  void expect_distance(std::string_view variant, double distance, const Samples& a, const Samples& b) {
    const auto text = [&](double threshold) {
      return "rhf:patch=0," + std::string(variant) + "threshold=" + std::to_string(threshold);
    };
    EXPECT_FALSE(merged(text(distance * (1 - 1e-5)), a, b)) << variant << distance;
    EXPECT_TRUE(merged(text(distance * (1 + 1e-5)), a, b)) << variant << distance;
  }
};

TEST_F(Rhf, FindsNoDistanceBetweenEqualHistogramsOfWhateverCounts) {
  const Samples many{32, {{0, 4}, {3, 20}, {19, 8}}}, few{8, {{0, 1}, {3, 5}, {19, 2}}};
  for (const std::string_view text : {"rhf:patch=0,threshold=0.001", "rhf:threshold=0.001"}) {
    EXPECT_TRUE(merged(text, many, many));
    EXPECT_TRUE(merged(text, many, few));
    EXPECT_TRUE(merged(text, few, many));
  }
}

TEST_F(Rhf, MeasuresChiSquarePerBin) {
  // Two bins a channel, each (16 * 16)^2 / (16 * 16 * 16) = 16.
  expect_distance("", 16, {16, {{5, 16}}}, {16, {{6, 16}}});
  // (sqrt(2) 8)^2 / 8 = 16, (sqrt(1/2) 16)^2 / 16 = 8.
  expect_distance("", 12, {8, {{5, 8}}}, {16, {{6, 16}}});
  // One bin of 12 and 8, one of 4 and 8: 16 / 20 and 16 / 12.
  expect_distance("", (16.0 / 20 + 16.0 / 12) / 2, {16, {{5, 12}, {6, 4}}}, {16, {{5, 8}, {6, 8}}});
  // 100 and 300 samples in four fours of bins: exact to float's precision.
  const double terms = std::pow(std::sqrt(3.0) * 70 - 120 / std::sqrt(3.0), 2) / 190 +
                       std::pow(std::sqrt(3.0) * 29, 2) / 29 + std::pow(90 / std::sqrt(3.0), 2) / 90 +
                       std::pow(std::sqrt(3.0) - 90 / std::sqrt(3.0), 2) / 91;
  expect_distance("", terms / 4, {100, {{0, 70}, {7, 29}, {19, 1}}}, {300, {{0, 120}, {12, 90}, {19, 90}}});
}

TEST_F(Rhf, LeavesBinsOfOneSampleOutWhereOnlySharedOnesCount) {
  const Samples a{16, {{5, 12}, {6, 4}}}, b{16, {{5, 9}, {6, 6}, {9, 1}}};
  const double shared = 9.0 / 21 + 4.0 / 10;
  expect_distance("", (shared + 1) / 3, a, b);
  expect_distance("bins=shared,", shared / 2, a, b);
  EXPECT_FALSE(merged("rhf:patch=0,bins=shared,threshold=1000", {1, {{5, 1}}}, {1, {{6, 1}}}))
      << "nothing is shared";
}

TEST_F(Rhf, ComparesPatchesByTheMeanOverAllTheirBins) {
  // Of three pixels in a row the middle differs; pixel and patch distances of the outer ones: 0 and, of the
  // patches' two pairs inside the picture, (0 + 2 * 16) / (1 + 2) for the pair of neighbours.
  const FilterPlan loose = parse_filter("rhf:patch=1,threshold=10.7"),
                   strict = parse_filter("rhf:patch=1,threshold=10.6");
  const std::vector<Samples> pixels{{16, {{5, 16}}}, {16, {{5, 16}}}, {16, {{6, 16}}}};
  EXPECT_EQ(filtered(loose, row(loose, pixels)).at(0, 0, 0), 0.5f);
  EXPECT_EQ(filtered(strict, row(strict, pixels)).at(0, 0, 0), 0.0f);
}

TEST_F(Rhf, GivesAPixelWithoutSamplesToNobody) {
  const FilterPlan plan = parse_filter("rhf");
  const Samples some{16, {{5, 16}}}, none{0, {}};
  Image input = row(plan, {some, none, some});
  for (int b = 0; b < 3 * kHistogramBins; ++b) input.at(plane_of(plan, Aov::histogram, b), 1, 0) = 0;
  const Image result = filtered(plan, input);
  EXPECT_EQ(result.at(0, 0, 0), 1.0f);  // of 0 and 2
  EXPECT_EQ(result.at(0, 1, 0), 1.0f);  // itself
  // Patches about its neighbours cover it: that about 0 has the likes of 2, which bring 3, that about 2 of 3,
  // which bring 2.
  const FilterPlan patches = parse_filter("rhf:average=patches");
  EXPECT_EQ(filtered(patches, row(patches, {some, none, some, some})).at(0, 1, 0), 2.5f);
}

TEST_F(Rhf, MergesAcrossNoEdgeOfGuidesWhereItIsGated) {
  const Samples same{16, {{5, 16}}};
  const FilterPlan plan = parse_filter("rhf:patch=0,gate=3");
  const auto merges = [&](Aov aov, float difference) {
    Image input = row(plan, {same, same});
    for (int c = 0; c < 3; ++c)
      input.at(plane_of(plan, aov, c), 1, 0) = input.at(plane_of(plan, aov, c), 0, 0);
    input.at(plane_of(plan, aov, 1), 1, 0) += difference;
    return filtered(plan, input).at(0, 0, 0) == 0.5f;
  };
  EXPECT_TRUE(merges(Aov::albedo, 0.0899f));
  EXPECT_FALSE(merges(Aov::albedo, -0.0901f));
  EXPECT_TRUE(merges(Aov::normal, -0.359f));  // of -1..1, mapped to 0..1
  EXPECT_FALSE(merges(Aov::normal, 0.361f));
}

TEST_F(Rhf, AveragesTheWholeWindowWhereEverythingAgrees) {
  const Region region{-20, -20, 20, 20};  // of one surface
  for (const std::string_view text : {"rhf:radius=4", "rhf:radius=4,average=patches"}) {
    const FilterPlan plan = parse_filter(text);
    Image input = made_up_input(plan, region, "constant");
    for (int c = 0; c < 3; ++c) {
      std::ranges::fill(input.plane(plane_of(plan, Aov::color, c)), 0.0f);
      input.at(plane_of(plan, Aov::color, c), 0, 0) = 81;
    }
    const Image result = filtered(plan, input);
    for (int y = -14; y < 14; ++y)
      for (int x = -14; x < 14; ++x) {
        const bool near = std::max(std::abs(x), std::abs(y)) <= 4;
        ASSERT_NEAR(result.at(2, x, y), near ? 1 : 0, 1e-5) << text << " at " << x << ", " << y;
      }
  }
}

}  // namespace
}  // namespace tessera
