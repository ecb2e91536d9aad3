// SPDX-License-Identifier: Apache-2.0
// The kernels against the scalar references.
#include <cmath>

#include "tests/reference/atrous.h"
#include "tests/reference/svgf.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

// Exponents carry an error of some ulps of up to 127, cosines are raised to a power of 128, five levels add
// up; weights below 2^-126 are 0.
constexpr double kRelative = 1e-4;
// Where light spans 60 decades, the smallest weights decide, and the variance that sets them was decided
// likewise.
constexpr double kRelativeExtreme = 1e-3;
constexpr double kSmallestWeight = 0x1p-125;

void expect_close(const Image& result, const Image& expected, double relative, const std::string& what) {
  double largest = 0, worst = 0;
  for (const float v : expected.data()) largest = std::max(largest, std::abs(double(v)));
  for (std::size_t i = 0; i < expected.data().size(); ++i) {
    const double e = expected.data()[i], difference = std::abs(result.data()[i] - e);
    ASSERT_TRUE(difference <= relative * std::abs(e) + kSmallestWeight * largest)
        << what << ", value " << i << ": " << result.data()[i] << " is not " << e;
    if (e != 0) worst = std::max(worst, difference / std::abs(e));
  }
  testing::Test::RecordProperty(what, std::to_string(worst));
}

Image reference_of(const FilterPlan& plan, const Image& input) {
  return plan.name == "svgf" ? reference::svgf(plan, input) : reference::atrous(plan, input);
}

// Where light spans 60 decades, this variance is the rounding of a difference of equal moments: the formula
// says nothing.
bool variance_from_picture(const FilterPlan& plan) {
  return to_string(plan).find("spatial") != std::string::npos;
}

class AgainstReference : public OnDevice {
 protected:
  void compare(const FilterPlan& plan, const Region& region) {
    for (const std::string_view kind : kKinds) {
      if (kind == "extreme" && variance_from_picture(plan)) continue;
      const Image input = made_up_input(plan, region, kind);
      expect_close(filtered(plan, input), reference_of(plan, input),
                   kind == "extreme" ? kRelativeExtreme : kRelative,
                   to_string(plan) + " on " + std::string(kind));
    }
  }
};

TEST_F(AgainstReference, EveryFilterComputesItsFormulasOnEveryKindOfInput) {
  for (const std::string_view text : kFilterTexts) compare(parse_filter(text), {0, 0, 61, 47});
}

TEST_F(AgainstReference, ParametersReachTheKernels) {
  for (const std::string_view text :
       {"atrous:levels=1", "atrous:sigma_c=0.1", "atrous:sigma_n=1", "atrous:sigma_x=1", "svgf:levels=2",
        "svgf:sigma_z=3", "svgf:sigma_n=1", "svgf:sigma_l=0.5"}) {
    const FilterPlan plan = parse_filter(text), standard = parse_filter(plan.name);
    compare(plan, {-5, 3, 32, 32});
    const Image input = made_up_input(plan, {-5, 3, 32, 32}, "noise");
    EXPECT_FALSE(same_bits(filtered(plan, input), filtered(standard, input))) << text;
  }
}

TEST_F(AgainstReference, LightOfSixtyDecadesStaysBetweenItsBounds) {
  const FilterPlan plan = parse_filter("svgf:variance=spatial");
  const Image result = filtered(plan, made_up_input(plan, {0, 0, 61, 47}, "extreme"));
  for (const float v : result.data()) ASSERT_TRUE(v >= 0 && v <= 4e30f) << v;
}

TEST_F(AgainstReference, PicturesOfOnePixelOneRowAndOneColumnAreFiltered) {
  for (const std::string_view text : kFilterTexts)
    for (const Region& region : {Region{0, 0, 1, 1}, Region{3, 9, 50, 10}, Region{7, 0, 8, 41}})
      compare(parse_filter(text), region);
}

}  // namespace
}  // namespace tessera
