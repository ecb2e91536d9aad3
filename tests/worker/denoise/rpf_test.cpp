// SPDX-License-Identifier: Apache-2.0
// What is true of Random Parameter Filtering in particular.
#include <cmath>
#include <random>

#include "core/filter/rpf.h"
#include "kernels.h"
#include "tests/reference/rpf.h"
#include "tests/worker/denoise/denoise_test.h"
#include "worker/denoise/device_cl.h"

namespace tessera {
namespace {

constexpr int kBuckets = 11;

int plane(const FilterPlan& plan, Share half, int slot, int number) {
  const std::vector<Channel> inputs = plan.inputs();
  const Channel wanted{Aov::sample_vectors, slot * SampleVector::size + number, Statistic::mean, half};
  return static_cast<int>(std::ranges::find(inputs, wanted) - inputs.begin());
}

class RandomParameterFilter : public OnDevice {
 protected:
  void compare(std::string_view text, const Region& region, double relative) {
    const FilterPlan plan = parse_filter(text);
    for (const std::string_view kind : {"noise", "sky", "firefly"}) {
      const Image input = made_up_input(plan, region, kind);
      const Image result = filtered(plan, input), expected = reference::rpf(plan, input);
      // A single neighbour a million times brighter leaves few digits of the others' deviation.
      const double allowed = kind == "firefly" ? 10 * relative : relative;
      double worst = 0;
      for (std::size_t i = 0; i < expected.data().size(); ++i) {
        const double e = expected.data()[i];
        ASSERT_NEAR(result.data()[i], e, allowed * e) << text << " on " << kind << ", value " << i;
        worst = std::max(worst, std::abs(result.data()[i] / e - 1));
      }
      RecordProperty(std::string(text) + " on " + std::string(kind), std::to_string(worst));
    }
  }

  // Mutual information, in bits, of each of the 19 features and colours (rows) with each of the 11 random
  // parameters, screen positions and colours, of samples given as lines of 32 numbers.
  std::vector<float> information(const std::vector<float>& lines) {
    auto& cl = dynamic_cast<ClDevice&>(*device_);
    const std::lock_guard lock(cl.mutex());
    std::string source;
    for (const std::string_view part : {kernels::rpf_neighbours_cl, kernels::rpf_information_cl})
      source += part;
    source +=
        "kernel void evaluate(global const float* lines, int count, global const uint* table,"
        "                     global float* result) {"
        "  Neighbours n; Histograms h; float16 about[2]; float row[COLUMNS];"
        "  n.count = count;"
        "  for (int i = 0; i < count; ++i) n.at[i] = i;"
        "  for (int v = 0; v < 2; ++v) about[v] = vload16(v, lines);"
        "  measure(&n, lines, about);"
        "  set_up(&h, &n, 11);"
        "  count_pairs(&h, &n, lines);"
        "  for (int r = 0; r < ROWS; ++r) {"
        "    information(&h, count, r, table, row);"
        "    for (int c = 0; c < COLUMNS; ++c) result[r * COLUMNS + c] = c < row_columns(r) ? row[c] : 0;"
        "  }"
        "}";
    std::vector<float> result(19 * 11), table;
    for (int n = 0; n < 16384; ++n)
      table.push_back(std::bit_cast<float>(
          static_cast<std::uint32_t>(n < 2 ? 0 : std::llround(16384 * n * std::log2(n)))));
    cl::Kernel kernel(cl.program(source), "evaluate");
    cl::Buffer in = cl.borrowed(std::span(lines)), lookup = cl.borrowed(std::span<const float>(table)),
               out = cl.borrowed(std::span(result));
    kernel.setArg(0, in);
    kernel.setArg(1, static_cast<cl_int>(lines.size() / 32));
    kernel.setArg(2, lookup);
    kernel.setArg(3, out);
    cl.run(kernel, 1, 1);
    cl.finish(out, result);
    return result;
  }
};

// Lines of independent uniform numbers.
std::vector<float> uniform_lines(int count, unsigned seed) {
  std::minstd_rand random(seed);
  random.discard(100);
  std::vector<float> lines(static_cast<std::size_t>(count) * 32);
  for (float& v : lines) v = std::uniform_real_distribution<float>(0, 1)(random);
  return lines;
}

// Buckets of one number of all lines, in double precision.
std::vector<int> buckets(const std::vector<float>& lines, int number) {
  const double n = static_cast<double>(lines.size()) / 32;
  double mean = 0, square = 0;
  for (std::size_t i = 0; i < lines.size(); i += 32) mean += lines[i + number] / n;
  for (std::size_t i = 0; i < lines.size(); i += 32) square += std::pow(lines[i + number] - mean, 2) / n;
  std::vector<int> all;
  for (std::size_t i = 0; i < lines.size(); i += 32) {
    const double z = square > 0 ? (lines[i + number] - mean) / std::sqrt(square) : 0;
    all.push_back(std::clamp(static_cast<int>(std::floor(z + kBuckets / 2.0)), 0, kBuckets - 1));
  }
  return all;
}

TEST_F(RandomParameterFilter, ComputesItsFormulasWithThePapersBoxesAndItsVariants) {
  // Neighbours, buckets and counts are the same numbers in both; what is left are roundings of weights. The
  // histograms' logarithms are whole multiples of 2^-14, which weighs most where few samples tell little.
  compare("rpf", {4, -3, 15, 6}, 1e-4);
  compare("rpf:preset=release2015,diameter=20", {4, -3, 15, 6}, 1e-4);
  for (const std::string_view rest :
       {"sigma8=0.002", "draws=0.5", "buckets=5", "second_hit=plain", "seed=7", "diameter=20", "box4=7"}) {
    compare("rpf:box1=9,box2=5,box3=3," + std::string(rest), {-2, 5, 12, 16}, 1e-4);
  }
}

TEST_F(RandomParameterFilter, ParametersReachTheKernels) {
  const Region region{-2, 5, 12, 16};
  const auto result = [&](const std::string& text) {
    const FilterPlan plan = parse_filter(text);
    return filtered(plan, made_up_input(plan, region, "noise"));
  };
  const Image standard = result("rpf:diameter=1");
  EXPECT_TRUE(same_bits(standard, result("rpf:diameter=1,seed=0")));
  for (const std::string_view parameter : {"preset=release2015", "sigma8=0.002", "box1=9", "box2=9", "box3=9",
                                           "box4=9", "draws=0.5", "buckets=5", "seed=7", "seed=4294967295"})
    EXPECT_FALSE(same_bits(standard, result("rpf:diameter=1," + std::string(parameter)))) << parameter;
  EXPECT_FALSE(same_bits(standard, result("rpf:diameter=100")));
}

TEST_F(RandomParameterFilter, TellsASecondHitAtTheOriginFromNone) {
  const FilterPlan flagged = parse_filter("rpf:diameter=20"),
                   plain = parse_filter("rpf:diameter=20,second_hit=plain");
  Image input = made_up_input(plain, {0, 0, 12, 9}, "noise");
  EXPECT_TRUE(same_bits(filtered(flagged, input), filtered(plain, input))) << "all samples have one";
  for (const Share half : {Share::a, Share::b})
    for (int number = SampleVector::position2; number < SampleVector::albedo; ++number)
      for (int x = 0; x < 5; ++x)
        for (int y = 0; y < 9; ++y)
          for (int slot = 1; slot < 4; ++slot) input.at(plane(plain, half, slot, number), x, y) = 0;
  EXPECT_FALSE(same_bits(filtered(flagged, input), filtered(plain, input)));
}

TEST_F(RandomParameterFilter, OfTilesWithThePapersBoxesIsThatOfTheFrame) {
  for (const std::string text : {"rpf:diameter=20", "rpf:preset=release2015,diameter=20"}) {
    const FilterPlan plan = parse_filter(text);
    const Image input = made_up_input(plan, {-40, 7, 0, 37}, "sky");
    EXPECT_TRUE(same_bits(stitched(plan, input, {23, 17}), filtered(plan, input))) << text;
  }
}

TEST_F(RandomParameterFilter, NeedsAllOfItsHalo) {
  const Region frame{0, 0, 24, 24}, inner{10, 10, 14, 14};
  const FilterPlan plan = parse_filter("rpf:box1=5,box2=5,box3=3,box4=3,diameter=20");
  ASSERT_EQ(plan.halo(), 2 + 2 + 1 + 1);
  int caught = 0;
  for (unsigned seed = 0; seed < 8; ++seed) {
    const Image input = made_up_input(plan, frame, "noise", seed);
    const Image whole = cropped(filtered(plan, input), inner);
    const auto with_halo = [&](int halo) {
      const Region seen = grown(inner, halo);
      return filter(*device_, plan, cropped(input, seen), {inner, seen}, seen);
    };
    EXPECT_TRUE(same_bits(
        filter(*device_, plan, cropped(input, grown(inner, 6)), {inner, grown(inner, 6)}, frame), whole));
    caught += !same_bits(with_halo(plan.halo() - 1), whole);
  }
  EXPECT_EQ(caught, 8);
}

TEST_F(RandomParameterFilter, CountsSamplesThatBothHalvesHoldOnce) {
  const FilterPlan plan = parse_filter("rpf:diameter=20");
  Image twice = made_up_input(plan, {0, 0, 12, 9}, "noise"), once = twice;
  for (int slot = 0; slot < 4; ++slot)
    for (int number = 0; number < SampleVector::size; ++number) {
      std::ranges::copy(twice.plane(plane(plan, Share::a, slot, number)),
                        twice.plane(plane(plan, Share::b, slot, number)).begin());
      std::ranges::fill(once.plane(plane(plan, Share::b, slot, number)), 0.0f);
    }
  EXPECT_TRUE(same_bits(filtered(plan, twice), filtered(plan, once)));
}

TEST_F(RandomParameterFilter, PassesOverSamplesThatWereDropped) {
  const FilterPlan plan = parse_filter("rpf:diameter=20");
  Image dropped = made_up_input(plan, {0, 0, 12, 9}, "noise"), broken = dropped;
  for (int number = 0; number < SampleVector::size; ++number)
    dropped.at(plane(plan, Share::b, 2, number), 5, 4) = 0;
  broken.at(plane(plan, Share::b, 2, SampleVector::bounce), 5, 4) = NAN;
  const Image result = filtered(plan, broken);
  EXPECT_TRUE(same_bits(result, filtered(plan, dropped)));
  for (const float v : result.data()) ASSERT_TRUE(std::isfinite(v));
}

// Light that the lens decides, on two surfaces that differ in colour.
TEST_F(RandomParameterFilter, SmoothsWhatDependsOnTheLensAndKeepsWhatDependsOnTheSurface) {
  const FilterPlan plan = parse_filter("rpf:diameter=1");
  const Region region{0, 0, 24, 24};
  Image input = made_up_input(plan, region, "constant");
  std::minstd_rand random(5);
  std::uniform_real_distribution<float> uniform(0, 1);
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x)
      for (const Share half : {Share::a, Share::b})
        for (int slot = 0; slot < 4; ++slot) {
          const float lens = uniform(random), albedo = x < 12 ? 0.2f : 0.8f;
          const auto put = [&](int number, float v) { input.at(plane(plan, half, slot, number), x, y) = v; };
          put(SampleVector::lens, lens);
          for (int k = 0; k < 3; ++k) {
            put(SampleVector::albedo + k, albedo);
            put(SampleVector::color + k, 2 * albedo * lens);
          }
        }
  const Image result = filtered(plan, input);
  double square = 0;
  for (int y = 0; y < 24; ++y)
    for (int x = 0; x < 24; ++x) {
      const double expected = x < 12 ? 0.2 : 0.8;
      square += std::pow(result.at(1, x, y) / expected - 1, 2) / (24 * 24);
      ASSERT_NEAR(result.at(1, x, y), expected, 0.25 * expected) << x << ", " << y;
    }
  // A pixel's mean of eight uniform numbers deviates by 20 %.
  EXPECT_LT(std::sqrt(square), 0.06);
}

TEST_F(RandomParameterFilter, FindsWhatNumbersTellOfThemselvesToBeTheirEntropy) {
  for (const int count : {8, 500, 1700, 9000}) {
    std::vector<float> lines = uniform_lines(count, 3);
    for (std::size_t i = 0; i < lines.size(); i += 32) {
      lines[i + 4] = lines[i + 18];                           // a feature, a random parameter
      lines[i + 25] = lines[i + 22] = lines[i + 22] * 2 - 9;  // a colour, a place on the screen
      lines[i + 7] = 0.3f;
    }
    const std::vector<float> result = information(lines);
    const auto entropy = [&](int k) {
      return reference::mutual_information(buckets(lines, k), buckets(lines, k));
    };
    EXPECT_NEAR(result[4 * 11 + 2], entropy(4), 1e-5) << count;
    EXPECT_NEAR(result[17 * 11 + 6], entropy(22), 1e-5) << count;
    for (int c = 0; c < 11; ++c) EXPECT_EQ(result[7 * 11 + c], 0.0f) << "what is constant tells nothing";
  }
}

TEST_F(RandomParameterFilter, CountsEveryPairOfNumbersAsTheFormulaSays) {
  for (const int count : {1, 31, 513, 1536, 3585, 7680, 8000}) {
    std::vector<float> lines = uniform_lines(count, 9);
    for (std::size_t i = 0; i < lines.size(); i += 32) {
      lines[i + 1] = std::pow(lines[i + 17], 6.0f);  // far out on one side
      lines[i + 24] = 1 / (0.01f + lines[i + 20]);
      lines[i + 23] = std::floor(3 * lines[i + 2]);
    }
    const std::vector<float> result = information(lines);
    for (int row = 0; row < 19; ++row)
      for (int column = 0; column < (row < 16 ? 11 : 8); ++column) {
        const double expected = reference::mutual_information(buckets(lines, row < 16 ? row : row + 8),
                                                              buckets(lines, 16 + column));
        // A bucket of one sample more or less where the number lies on the edge.
        ASSERT_NEAR(result[row * 11 + column], expected, 1e-5 + 2e-2 / count)
            << count << ": " << row << ", " << column;
      }
  }
}

TEST_F(RandomParameterFilter, FindsAsMuchInIndependentNumbersAsTheirCountExplains) {
  constexpr int kSamples = 4000, kOccupied = 5;  // uniform numbers lie within 1.73 deviations
  const std::vector<float> result = information(uniform_lines(kSamples, 11));
  double mean = 0;
  for (int row = 0; row < 16; ++row)
    for (int c = 0; c < 11; ++c) mean += result[row * 11 + c] / (16 * 11);
  // Of (B - 1)^2 independent deviations each holds 1 / (2 N ln 2) bits on average; 176 pairs hold it to 5 %.
  const double bias = (kOccupied - 1) * (kOccupied - 1) / (2 * kSamples * std::log(2.0));
  EXPECT_NEAR(mean, bias, 0.15 * bias);
}

TEST(RandomParameterWeights, LieBetweenZeroAndOneWhateverTheDependencies) {
  std::minstd_rand random(2);
  std::uniform_real_distribution<double> exponent(-9, 1);
  double least = 1, most = 0;
  for (int i = 0; i < 2000; ++i) {
    reference::RpfDependencies d;
    const auto draw = [&] { return i % 7 == 0 ? 0 : std::pow(10, exponent(random)); };
    for (int k = 0; k < 16; ++k) {
      d.feature_random.push_back(draw());
      d.feature_screen.push_back(draw());
      d.color_feature.push_back(draw());
    }
    for (int k = 0; k < 3; ++k) d.color_random[k] = draw(), d.color_screen[k] = draw();
    const reference::RpfWeights w = reference::rpf_weights(d, 1 + 0.1 * (i % 4));
    std::vector<double> all = w.beta;
    all.insert(all.end(), {w.alpha[0], w.alpha[1], w.alpha[2], w.contribution});
    for (const double v : all) {
      ASSERT_TRUE(v >= 0 && v <= 1) << v;
      least = std::min(least, v);
      most = std::max(most, v);
    }
  }
  EXPECT_EQ(least, 0);
  EXPECT_GT(most, 0.9);
}

TEST(RandomParameterPlan, HasTheHaloOfItsBoxes) {
  EXPECT_EQ(parse_filter("rpf").halo(), 27 + 17 + 8 + 3);
  EXPECT_EQ(parse_filter("rpf:preset=release2015").halo(), 22 + 15 + 7 + 2);
  EXPECT_EQ(parse_filter("rpf:box1=7,box2=1").halo(), 3 + 0 + 8 + 3);
}

}  // namespace
}  // namespace tessera
