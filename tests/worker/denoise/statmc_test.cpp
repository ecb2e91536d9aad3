// SPDX-License-Identifier: Apache-2.0
// What is true of the statistical denoiser (Sakai et al. 2024).
#include <cmath>
#include <random>

#include "tests/reference/statmc.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class StatMc : public OnDevice {
 protected:
  // Two pixels on one plain surface, black and white, of n samples each. Their transformed means lie
  // `distance` apart in green; each mean has the given variance.
  struct Pair {
    double n = 16, distance = 0, variance = 0.01, third = 0, second_n = 0;
  };
  // The white's share of what becomes of the black pixel.
  double shared(const Pair& pair, std::string_view text = "statmc") {
    const FilterPlan plan = parse_filter(text);
    Image input = made_up_input(plan, {0, 0, 2, 1}, "constant");
    for (int x = 0; x < 2; ++x) {
      for (int c = 0; c < 3; ++c) {
        input.at(plane_of(plan, Aov::color, c), x, 0) = static_cast<float>(x);
        input.at(plane_of(plan, Aov::box_cox, c), x, 0) = c == 1 ? static_cast<float>(x * pair.distance) : 0;
        const auto set = [&](Statistic s, double v) {
          input.at(plane_of(plan, Aov::box_cox, c, s), x, 0) = static_cast<float>(v);
        };
        set(Statistic::variance_of_mean, pair.variance);
        set(Statistic::third_moment, x == 1 && c == 1 ? pair.third : 0);
      }
      input.at(plane_of(plan, Aov::color, 0, Statistic::samples), x, 0) =
          static_cast<float>(x == 1 && pair.second_n > 0 ? pair.second_n : pair.n);
    }
    return filtered(plan, input).at(0, 0, 0);
  }
};

// Where one of two pixels is kept, it weighs exp(-1 / (2 sigma_s^2)) against the centre's 1.
const double kKept = std::exp(-1 / 200.0) / (1 + std::exp(-1 / 200.0));

TEST_F(StatMc, RejectsAPixelExactlyFromTheQuantileOfStudentsTOn) {
  // Two-sided quantiles of 2 n - 2 degrees of freedom: of the table, of its end, of the expansion, and of the
  // normal distribution.
  struct Quantile {
    double n, t;
  };
  for (const auto& [n, t] :
       {Quantile{2, 14.0890}, Quantile{3, 5.59757}, Quantile{16, 3.02980}, Quantile{31, 2.91455},
        Quantile{32, 2.91097}, Quantile{33, 2.90761}, Quantile{61, 2.85986}, Quantile{1e7, 2.80703}}) {
    // (m_p - m_q)^2 <= t^2 (V_p + V_q)
    const double limit = t * std::sqrt(2 * 0.01);
    EXPECT_NEAR(shared({.n = n, .distance = limit * (1 - 1e-5)}), kKept, 1e-6) << n;
    EXPECT_EQ(shared({.n = n, .distance = limit * (1 + 1e-5)}), 0) << n;
  }
}

TEST_F(StatMc, RejectsAtTheLevelThatIsAskedFor) {
  for (const double level : {1e-6, 0.5})
    for (const double n : {2, 9, 32, 33, 500}) {
      const std::string text = "statmc:level=" + std::to_string(level);
      const double limit = reference::student_quantile(level, 2 * n - 2) * std::sqrt(2 * 0.01);
      EXPECT_NEAR(shared({.n = n, .distance = limit * (1 - 1e-5)}, text), kKept, 1e-6) << text << ", n " << n;
      EXPECT_EQ(shared({.n = n, .distance = limit * (1 + 1e-5)}, text), 0) << text << ", n " << n;
    }
}

TEST_F(StatMc, WidensEachPixelsIntervalByItsOwnSamples) {
  const double limit = std::sqrt(0.01 * (14.08905 * 14.08905 + 3.029798 * 3.029798));
  EXPECT_GT(shared({.n = 16, .distance = limit * (1 - 1e-5), .second_n = 2}), 0);
  EXPECT_EQ(shared({.n = 16, .distance = limit * (1 + 1e-5), .second_n = 2}), 0);
}

TEST_F(StatMc, CorrectsAMeanForTheSkewnessOfItsSamples) {
  // Johnson 1978: by m3 / (6 s^2 n), s^2 = n V.
  const double limit = 3.029798 * std::sqrt(2 * 0.01), correction = 0.3 / (6 * 16 * 0.01 * 16);
  for (const double sign : {-1, 1}) {
    const double moved = limit - sign * correction;
    EXPECT_GT(shared({.distance = moved * (1 - 1e-5), .third = sign * 0.3}), 0);
    EXPECT_EQ(shared({.distance = moved * (1 + 1e-5), .third = sign * 0.3}), 0);
  }
}

TEST_F(StatMc, KeepsWhatOneSampleCannotTellApartAndPartsWhatHasNoVariance) {
  EXPECT_NEAR(shared({.n = 1, .distance = 1000, .variance = 0}), kKept, 1e-6);
  EXPECT_EQ(shared({.n = 2, .distance = 1e-6, .variance = 0}), 0);
  EXPECT_NEAR(shared({.n = 2, .distance = 0, .variance = 0}), kKept, 1e-6);
}

TEST_F(StatMc, LooksAtADiscWithGaussianWeights) {
  const FilterPlan plan = parse_filter("statmc:radius=7,sigma_s=5");
  const Region region{-20, -20, 20, 20};
  Image input = made_up_input(plan, region, "constant");
  for (int c = 0; c < 3; ++c) {
    std::ranges::fill(input.plane(plane_of(plan, Aov::color, c)), 0.0f);
    input.at(plane_of(plan, Aov::color, c), 0, 0) = 1;
    std::ranges::fill(input.plane(plane_of(plan, Aov::box_cox, c, Statistic::third_moment)), 0.0f);
  }
  const auto weight = [](int i, int j) {
    const int d2 = i * i + j * j;
    return d2 <= 49 ? std::exp(-d2 / 50.0) : 0;
  };
  double sum = 0;
  for (int j = -7; j <= 7; ++j)
    for (int i = -7; i <= 7; ++i) sum += weight(i, j);
  const Image result = filtered(plan, input);
  for (int y = -13; y < 13; ++y)  // where no tap falls outside
    for (int x = -13; x < 13; ++x) {
      ASSERT_NEAR(result.at(1, x, y), weight(x, y) / sum, 1e-6) << x << ", " << y;
    }
}

TEST_F(StatMc, HalvesNoiseManyTimesAndKeepsAnEdgeThatOnlyTheSamplesShow) {
  // Normally distributed samples of two brightnesses, without any guide between them.
  const FilterPlan plan = parse_filter("statmc");
  const Region region{-64, -64, 0, 0};
  constexpr double kN = 16, kDeviation = 0.1;
  Image input = made_up_input(plan, region, "constant");
  std::mt19937 random(20241203);
  std::normal_distribution<double> noise(0, kDeviation / std::sqrt(kN));
  for (int y = -64; y < 0; ++y)
    for (int x = -64; x < 0; ++x) {
      const double v = (x < -32 ? 1 : 2) + noise(random);
      for (int c = 0; c < 3; ++c) {
        input.at(plane_of(plan, Aov::color, c), x, y) = static_cast<float>(v);
        input.at(plane_of(plan, Aov::box_cox, c), x, y) = static_cast<float>(v);
        input.at(plane_of(plan, Aov::box_cox, c, Statistic::variance_of_mean), x, y) =
            static_cast<float>(kDeviation * kDeviation / kN);
        input.at(plane_of(plan, Aov::box_cox, c, Statistic::third_moment), x, y) = 0;
      }
    }
  const Image result = filtered(plan, input);
  double squares = 0;
  for (int y = -64; y < 0; ++y)
    for (int x = -64; x < 0; ++x) squares += std::pow(result.at(0, x, y) - (x < -32 ? 1 : 2), 2);
  EXPECT_LT(std::sqrt(squares / 4096), kDeviation / std::sqrt(kN) / 6);
}

}  // namespace
}  // namespace tessera
