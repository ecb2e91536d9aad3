// SPDX-License-Identifier: Apache-2.0
// What is true of the filters whatever their arithmetic.
#include <cmath>
#include <limits>
#include <random>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Filters : public OnDevice {};

Image rotated_by_180_degrees(const Image& image) {
  Image out = image;
  for (int p = 0; p < image.planes(); ++p) std::ranges::reverse(out.plane(p));
  return out;
}

void expect_near(const Image& a, const Image& b, double relative, std::string_view what) {
  for (std::size_t i = 0; i < a.data().size(); ++i)
    ASSERT_NEAR(a.data()[i], b.data()[i], relative * std::abs(b.data()[i])) << what << ", value " << i;
}

void fill(Image& input, const FilterPlan& plan, Aov aov, float value, Statistic statistic = Statistic::mean) {
  for (int c = 0; c < info(aov).channels; ++c)
    std::ranges::fill(input.plane(plane_of(plan, aov, c, statistic)), value);
}

// Two-dimensional weights of the first `levels` levels of B3, applied to a single lit pixel at the centre.
std::vector<double> impulse_response(int levels, int radius) {
  std::vector<double> line(2 * radius + 1);
  line[radius] = 1;
  constexpr double weights[] = {1.0 / 16, 1.0 / 4, 3.0 / 8, 1.0 / 4, 1.0 / 16};
  for (int level = 0; level < levels; ++level) {
    std::vector<double> next(line.size());
    for (int i = 0; i < static_cast<int>(line.size()); ++i)
      for (int k = -2; k <= 2; ++k) {
        const int from = i + k * (1 << level);
        if (from >= 0 && from < static_cast<int>(line.size())) next[i] += weights[k + 2] * line[from];
      }
    line = next;
  }
  return line;
}

// Flat white surfaces without an edge stop in the colour, so that every level is the plain B3 kernel.
struct Plain {
  FilterPlan plan;
  Image input;
};
Plain plain_svgf(int levels, const Region& region) {
  Plain p{parse_filter("svgf:sigma_l=1000,levels=" + std::to_string(levels)), {}};
  p.input = made_up_input(p.plan, region, "constant");
  fill(p.input, p.plan, Aov::albedo, 1);
  fill(p.input, p.plan, Aov::depth, 4);
  for (const float z : {0.0f, 1.0f})
    std::ranges::fill(p.input.plane(plane_of(p.plan, Aov::normal, 2 * int(z))), z);
  for (const Aov a : {Aov::direct, Aov::indirect}) {
    fill(p.input, p.plan, a, 0);
    fill(p.input, p.plan, a, 1e12f, Statistic::variance_of_mean);
  }
  return p;
}

TEST_F(Filters, WriteAllOfTheirResultWhateverItsMemoryHeld) {
  const Region frame{0, 0, 33, 26};
  for (const FilterCase& c : filter_cases()) {
    const FilterPlan plan = parse_filter(c.text);
    const Image input = made_up_input(plan, frame, "sky"), fresh = filtered_and_kept(plan, input);
    recycle(*device_, Image(grown(frame, 1), fresh.planes(), NAN));
    EXPECT_TRUE(same_bits(filtered_and_kept(plan, input), fresh)) << c.text;
  }
}

TEST_F(Filters, LeaveAConstantPictureAsItIs) {
  for (const FilterCase& c : filter_cases()) {
    const FilterPlan plan = parse_filter(c.text);
    const Image result = filtered(plan, made_up_input(plan, {0, 0, 90, 70}, "constant"));
    const float light = light_of(plan) == Aov::color ? 0.7f : 2 * 0.7f;
    for (const float v : result.data()) ASSERT_NEAR(v, light, c.constant * light) << c.text;
  }
}

TEST_F(Filters, LeaveWhatHasNoVarianceAsItIs) {
  const FilterPlan plan = parse_filter("svgf");
  const Image input = made_up_input(plan, {0, 0, 60, 50}, "converged");
  const Image result = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < result.plane(c).size(); ++i) {
      float expected = 0;
      for (const Aov a : {Aov::direct, Aov::indirect, Aov::emission})
        expected += input.plane(plane_of(plan, a, c))[i];
      ASSERT_NEAR(result.plane(c)[i], expected, 1e-6f * expected + 1e-9f);
    }
}

TEST_F(Filters, CommuteWithATurnOf180Degrees) {
  for (const FilterCase& c : filter_cases())
    for (const std::string_view kind : {"noise", "sky"}) {
      if (!c.turns) continue;
      const std::string_view text = c.text;
      const FilterPlan plan = parse_filter(text);
      const Image input = made_up_input(plan, {0, 0, 83, 71}, kind);
      expect_near(filtered(plan, rotated_by_180_degrees(input)),
                  rotated_by_180_degrees(filtered(plan, input)), 2e-5, text);
    }
}

TEST_F(Filters, ScaleWithTheLight) {
  constexpr float kFactor = 8;
  for (const auto& [text, scaled_text] :
       {std::pair{"svgf", "svgf"}, std::pair{"bmfr", "bmfr"}, std::pair{"sbf", "sbf"},
        std::pair{"atrous:sigma_c=0.5", "atrous:sigma_c=4"},
        std::pair{"svgf:variance=spatial", "svgf:variance=spatial"}}) {
    const FilterPlan plan = parse_filter(text);
    Image input = made_up_input(plan, {0, 0, 64, 64}, "noise");
    Image expected = filtered(plan, input);
    for (float& v : expected.data()) v *= kFactor;
    for (int k = 0; k < input.planes(); ++k) {
      const Channel c = plan.inputs()[k];
      if (c.aov > Aov::emission) continue;  // light comes first in the list of AOVs
      for (float& v : input.plane(k)) v *= c.statistic == Statistic::mean ? kFactor : kFactor * kFactor;
    }
    expect_near(filtered(parse_filter(scaled_text), input), expected, 1e-5, text);
  }
}

TEST_F(Filters, DoNotLookAtTheColourOfTheSky) {
  for (const FilterCase& c : filter_cases()) {
    if (!c.parts_sky) continue;
    const std::string_view text = c.text;
    const FilterPlan plan = parse_filter(text);
    const Region region{0, 0, 70, 50};
    Image input = made_up_input(plan, region, "sky"), other = input;
    const int depth = plane_of(plan, Aov::depth, 0);
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x)
        if (input.at(depth, x, y) == kSkyDepth) put_sky(other, plan, x, y, 1e20f);
    const Image a = filtered(plan, input), b = filtered(plan, other);
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x)
        for (int k = 0; k < 3; ++k) {
          const bool sky = input.at(depth, x, y) == kSkyDepth;
          const float expected = sky ? 1e20f : a.at(k, x, y);
          ASSERT_EQ(b.at(k, x, y), expected) << text << " at " << x << ", " << y;
          if (sky) {
            const Aov behind = light_of(plan) == Aov::color ? Aov::color : Aov::emission;
            ASSERT_EQ(a.at(k, x, y), input.at(plane_of(plan, behind, k), x, y)) << "sky passes through";
          }
        }
  }
}

TEST_F(Filters, TurnANonFinitePixelBlackAndKeepItToItself) {
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                       -std::numeric_limits<float>::infinity()};
  for (const FilterCase& c : filter_cases()) {
    const std::string_view text = c.text;
    const FilterPlan plan = parse_filter(text);
    const Region region{0, 0, 50, 40};
    Image as_sky = made_up_input(plan, region, "noise");
    put_sky(as_sky, plan, 20, 17, 0);
    const Image expected = filtered(plan, as_sky);
    for (const float v : bad)
      for (int channel = 0; channel < 3; ++channel) {
        Image input = made_up_input(plan, region, "noise");
        input.at(plane_of(plan, light_of(plan), channel), 20, 17) = v;
        Image result = filtered(plan, input);
        EXPECT_EQ(result.at(channel, 20, 17), 0.0f) << text;
        for (int k = 0; k < 3; ++k) result.at(k, 20, 17) = 0;
        for (const float f : result.data()) ASSERT_TRUE(std::isfinite(f)) << text;
        if (c.parts_sky) {
          EXPECT_TRUE(same_bits(result, expected)) << text;
        }
      }
  }
}

TEST_F(Filters, TakeDenormalLightForAsGoodAsNone) {
  const auto is_light = [](const Channel& c) {
    return c.aov <= Aov::emission ||
           (c.aov == Aov::sample_vectors && c.index % SampleVector::size >= SampleVector::color);
  };
  for (const FilterCase& c : filter_cases()) {
    const FilterPlan plan = parse_filter(c.text);
    Image input = made_up_input(plan, {0, 0, 40, 30}, "noise");
    const std::vector<Channel> inputs = plan.inputs();
    for (int k = 0; k < input.planes(); ++k)
      if (is_light(inputs[k]) && inputs[k].statistic != Statistic::samples)
        for (float& v : input.plane(k)) v *= 1e-40f;
    const Image result = filtered(plan, input);
    for (const float v : result.data()) ASSERT_LE(std::abs(v), 1e-37f) << c.text;
  }
}

TEST_F(Filters, PassAPixelThroughWhoseGuidesAreNotFinite) {
  for (const FilterCase& c : filter_cases()) {
    if (!c.parts_sky) continue;
    const std::string_view text = c.text;
    const FilterPlan plan = parse_filter(text);
    Image input = made_up_input(plan, {0, 0, 40, 30}, "noise");
    for (int k = 0; k < input.planes(); ++k)
      if (plan.inputs()[k].aov == Aov::depth) input.at(k, 11, 12) = std::numeric_limits<float>::quiet_NaN();
    const Image result = filtered(plan, input);
    for (const float v : result.data()) ASSERT_TRUE(std::isfinite(v)) << text;
    const bool whole = light_of(plan) == Aov::color;
    float expected = whole ? input.at(plane_of(plan, Aov::color, 1), 11, 12) : 0;
    if (!whole)
      for (const Aov a : {Aov::direct, Aov::indirect, Aov::emission})
        expected += input.at(plane_of(plan, a, 1), 11, 12);
    EXPECT_EQ(result.at(1, 11, 12), expected) << text;
  }
}

TEST_F(Filters, ShortenNoNormalThatIsAMeanOfOthers) {
  const FilterPlan plan = parse_filter("svgf");
  Image input = made_up_input(plan, {0, 0, 40, 30}, "noise");
  const Image expected = filtered(plan, input);
  for (int c = 0; c < 3; ++c)
    for (float& v : input.plane(plane_of(plan, Aov::normal, c))) v *= 0.5f;
  EXPECT_TRUE(same_bits(filtered(plan, input), expected));
}

TEST_F(Filters, SpreadALitPixelByTheChainedKernelWhereNothingStopsThem) {
  for (int levels = 1; levels <= 5; ++levels) {
    const int radius = (2 << levels) - 2;
    const Region region{-95, -95, 96, 96};  // no tap of a lit pixel falls outside
    Plain svgf = plain_svgf(levels, region);
    svgf.input.at(plane_of(svgf.plan, Aov::direct, 1), 0, 0) = 1;
    const Image result = filtered(svgf.plan, svgf.input);
    const std::vector<double> line = impulse_response(levels, 95);
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x) {
        const double expected = line[x + 95] * line[y + 95];
        ASSERT_NEAR(result.at(1, x, y), expected, 1e-5 * expected)
            << levels << " levels at " << x << ", " << y;
        if (std::max(std::abs(x), std::abs(y)) > radius) {
          ASSERT_EQ(expected, 0);
        }
      }
  }
}

TEST_F(Filters, ReduceWhiteNoiseByTheRootOfTheSquaredKernelsSum) {
  constexpr int kLevels = 3, kReach = 14, kEdge = 256;
  Plain svgf = plain_svgf(kLevels, {0, 0, kEdge, kEdge});
  std::mt19937 random(20170728);
  std::normal_distribution<float> noise(0, 1);
  for (float& v : svgf.input.plane(plane_of(svgf.plan, Aov::indirect, 0))) v = noise(random);
  const Image result =
      cropped(filtered(svgf.plan, svgf.input), {kReach, kReach, kEdge - kReach, kEdge - kReach});
  double squares = 0, expected = 1;
  for (const float v : result.plane(0)) squares += double(v) * v;
  double line = 0;
  for (const double w : impulse_response(kLevels, kReach)) line += w * w;
  expected = line * line;  // variance of the filtered noise
  // The correlated pixels count as area / (sum of squared autocorrelation), which 1 / line^2 bounds by a
  // factor of about 2; the variance estimate then has a relative deviation of sqrt(2 / count).
  const double count = static_cast<double>(result.region().area()) * expected / 2;
  EXPECT_NEAR(squares / result.region().area(), expected, 5 * expected * std::sqrt(2 / count));
}

}  // namespace
}  // namespace tessera
