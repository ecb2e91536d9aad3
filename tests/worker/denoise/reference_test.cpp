// SPDX-License-Identifier: Apache-2.0
// The kernels against the scalar references.
#include <cmath>
#include <span>

#include "core/filter/descriptions.h"
#include "tests/reference/references.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

// Weights below 2^-126 are 0.
constexpr double kSmallestWeight = 0x1p-125;
// Numbers below the smallest normal one change no parameter: those are tried without.
constexpr std::span kOrdinaryKinds = std::span(kKinds).first<std::size(kKinds) - 1>();

struct Bound {
  double relative, of_largest, absolute;
  Strays strays;
};

Bound bound_of(const FilterCase& c, std::string_view kind) {
  const double many_decades = std::max(c.relative, c.extreme);
  if (kind == "firefly") return {c.relative, std::max(c.of_largest, c.firefly), 0, c.of_fireflies};
  if (kind == "extreme" || kind == kWide) return {many_decades, c.of_largest, 0, c.of_extremes};
  if (kind == "denormal") return {many_decades, c.of_largest, c.flushed, c.of_denormals};
  return {c.relative, c.of_largest, 0, {}};
}

void expect_close(const Image& result, const Image& expected, const Bound& b, const std::string& what) {
  double largest = 0, worst = 0;
  std::size_t strays = 0;
  for (const float v : expected.data()) largest = std::max(largest, std::abs(double(v)));
  for (std::size_t i = 0; i < expected.data().size(); ++i) {
    const double e = expected.data()[i], difference = std::abs(result.data()[i] - e);
    const double least = b.absolute + kSmallestWeight * largest;
    const bool close = difference <= b.relative * std::abs(e) + b.of_largest * largest + least;
    const bool stray = difference <= b.strays.relative * std::abs(e) + b.strays.of_largest * largest;
    ASSERT_TRUE(close || stray) << what << ", value " << i << ": " << result.data()[i] << " is not " << e;
    strays += !close;
    if (e != 0) worst = std::max(worst, difference / std::abs(e));
  }
  // They come in pairs that weigh each other: two pixels, if there are some.
  const double size = static_cast<double>(expected.data().size());
  const double fewest = b.strays.share > 0 ? std::min(6.0, size / 20) : 0;
  ASSERT_LE(strays, std::max(b.strays.share * size, fewest)) << what;
  testing::Test::RecordProperty(what, std::to_string(worst));
}

bool is_light(const Channel& c) {
  const bool of_sample = c.aov == Aov::sample_vectors && c.index % SampleVector::size >= SampleVector::color;
  return c.statistic == Statistic::mean && (c.aov <= Aov::emission || of_sample);
}

// The largest mean of some light in its units. Some filters divide it by the albedo of where it is, 1e-3 and
// more, and multiply it by that of where it goes.
double reach_of(const FilterPlan& plan) {
  if (plan.name == "ddf") return 2;  // direct light and indirect light, added
  constexpr std::string_view divide[] = {"atrous", "bmfr", "guided", "sure-atrous", "svgf"};
  return std::ranges::find(divide, plan.name) == std::end(divide) ? 1 + 1e-6 : 1e3;
}

// A weighted mean lies between what it is a mean of, but for its rounding.
void expect_within_the_light(const FilterCase& c, const FilterPlan& plan, const Image& input,
                             const Image& result, const std::string& what) {
  double largest = 0;
  for (int k = 0; k < input.planes(); ++k)
    if (is_light(plan.inputs()[k])) largest = std::max(largest, double(std::ranges::max(input.plane(k))));
  for (int k = 0; k < 3; ++k)
    for (const float v : result.plane(k))
      ASSERT_TRUE(v >= -(c.below + 1e-6) * largest && v <= reach_of(plan) * largest)
          << what << ": " << v / largest;
}

class AgainstReference : public OnDevice {
 protected:
  // A picture, or a frame after others of which `history` was kept. Returns what the reference makes of it.
  Image compare(const FilterCase& c, const FilterPlan& plan, const Region& region, std::string_view kind,
                unsigned frame = 1, const Image& history = {}) {
    const std::string what =
        to_string(plan) + " on frame " + std::to_string(frame) + " of " + std::string(kind);
    const Image input = made_up_input(plan, region, kind, frame);
    const Image result = filtered_and_kept(plan, input, history);
    if (kind == "extreme") expect_within_the_light(c, plan, input, result, what);
    if (kind == "extreme" && c.squares) return compare(c, plan, region, kWide, frame, history);
    Image expected = reference::filtered(plan, input, history);
    expect_close(result, expected, bound_of(c, kind), what);
    return expected;
  }
  void compare(const FilterCase& c, const FilterPlan& plan, const Region& region,
               std::span<const std::string_view> kinds = kKinds) {
    for (const std::string_view kind : kinds) compare(c, plan, region, kind);
  }
  // Each frame with what the reference kept of the one before, for errors are not to add up; some of it is no
  // number.
  void compare_frames(const FilterCase& c, const FilterPlan& plan, const Region& region) {
    constexpr unsigned kFrames = 4;
    for (const std::string_view kind : kKinds) {
      Image history;
      for (unsigned frame = 1; frame <= kFrames; ++frame) {
        const Image expected = compare(c, plan, region, kind, frame, history);
        history = planes_of(expected, 3, plan.history());
        spoil(history, frame);
      }
    }
  }
  static void spoil(Image& history, unsigned frame) {
    constexpr float kBad[] = {NAN, INFINITY, -INFINITY, 1e33f}, kNoLengths[] = {NAN, 0.5f, -1, 1e9f};
    const std::size_t area = history.plane(0).size(), planes = static_cast<std::size_t>(history.planes());
    const std::size_t length = planes - kTracePlanes;
    for (std::size_t k = 0; k < area / 20; ++k) {
      const std::size_t plane = k % planes;
      history.data()[(k * 20 + frame) % area + plane * area] = (plane == length ? kNoLengths : kBad)[k % 4];
    }
  }
  // The variant must be as near to its formulas as `like` is, and differ from the plain filter.
  void compare_variant(const FilterCase& like, const FilterPlan& plan) {
    const FilterPlan standard = parse_filter(plan.name);
    const Region region{-5, 3, 32, 32};
    compare(like, plan, region, kOrdinaryKinds);
    const Image input = made_up_input(plan, region, "noise");
    EXPECT_FALSE(
        same_bits(filtered(plan, input), filtered(standard, made_up_input(standard, region, "noise"))))
        << to_string(plan);
  }
  // As near as the plain filter.
  void compare_variant(std::string_view text) {
    const FilterPlan plan = parse_filter(text);
    const auto& cases = filter_cases();
    const auto plain = std::ranges::find_if(
        cases, [&](const FilterCase& c) { return parse_filter(c.text).name == plan.name; });
    ASSERT_NE(plain, cases.end()) << text;
    compare_variant(*plain, plan);
  }
};

TEST_F(AgainstReference, EveryFilterComputesItsFormulasOnEveryKindOfInput) {
  for (const FilterCase& c : filter_cases())
    compare(c, parse_filter(c.text), c.slow ? Region{0, 0, 33, 26} : Region{0, 0, 61, 47});
}

TEST_F(AgainstReference, FiltersWithHistoryComputeTheirFormulasFromFrameToFrame) {
  for (const FilterCase& c : filter_cases()) {
    const FilterPlan plan = parse_filter(c.text);
    if (plan.history() > 0) compare_frames(c, plan, c.slow ? Region{0, 0, 33, 26} : Region{-3, 2, 46, 39});
  }
}

TEST_F(AgainstReference, ParametersOfHistoriesReachTheKernels) {
  constexpr FilterCase cases[] = {
      {.text = "atrous:history=on,alpha=0.7", .of_largest = 1e-9},
      {.text = "svgf:history=on,alpha=0.05,average=exponential,feedback=5",
       .firefly = 1e-9,
       .of_extremes = {.share = 0.005, .of_largest = 1},
       .of_denormals = {.share = 0.005, .of_largest = 1},
       .flushed = 1e-3},
      {.text = "svgf:history=on,levels=2,alpha=0.6,alpha_moments=0.3,variance=spatial",
       .of_largest = 1e-12,
       .squares = true,
       .flushed = 1e-3},
  };
  for (const FilterCase& c : cases) compare_frames(c, parse_filter(c.text), {4, 20, 40, 51});
}

TEST_F(AgainstReference, ParametersReachTheKernels) {
  constexpr std::string_view texts[] = {
      "atrous:levels=1",
      "atrous:sigma_c=0.1",
      "atrous:sigma_n=1",
      "atrous:sigma_x=1",
      "bilateral:width=5",
      "bilateral:sigma_s=0.1",
      "bilateral:sigma_r=0.1",
      "bmfr:block=16",
      "bmfr:grids=1",
      "bmfr:grids=2",
      "bmfr:grids=3",
      "bmfr:frame=7",
      "bmfr:regularisation=stochastic",
      "bmfr:epsilon=0.3",
      "bmfr:clamp=1",
      "bmfr:regularisation=stochastic,epsilon=0.1,frame=3",
      "bmfr:normals=off",
      "bmfr:normals=squared",
      "bmfr:positions=off",
      "bmfr:positions=off,normals=off",
      "bmfr:positions=on",
      "bmfr:gradients=on",
      "bmfr:material=on",
      "bmfr:material=on,positions=off,regularisation=stochastic,gradients=on",
      "box:width=9",
      "cross-bilateral:diameter=1000",
      "cross-bilateral:sigma_a=1",
      "cross-bilateral:sigma_d=0.1",
      "cross-bilateral:sigma_n=0.01",
      "cross-bilateral:sigma_r=0.1",
      "cross-bilateral:sigma_s=0.1",
      "cross-bilateral:width=11",
      "ddf:kw=11",
      "ddf:sigma_dc=0.1",
      "ddf:sigma_ic=0.1",
      "ddf:sigma_depth=0.2",
      "ddf:sigma_normal=0.05",
      "ddf:sigma_texture=1",
      "ddf:sigma_texture2=1",
      "ddf:direction=neighbours,sigma_direction=0.3",
      "ddf:s_depth=0.001",
      "ddf:s_normal=3",
      "ddf:s_texture=0",
      "ddf:s_texture2=3",
      "ddf:direction=neighbours,s_direction=0",
      "ddf:holes=on",
      "ddf:progressive=on",
      "ddf:diameter=40",
      "gaussian:sigma=0.7",
      "rhf:patch=0",
      "rhf:patch=2",
      "rhf:radius=3",
      "rhf:threshold=0.5",
      "sbf:diameter=20",
      "sbf:filters=3",
      "sbf:sigma_a=0.05",
      "sbf:sigma_d=10",
      "sbf:sigma_n=0.1",
      "sbf:smoothing=1",
      "guided:radius=2",
      "guided:epsilon=1",
      "guided:depth_scale=0.1",
      "statmc:radius=5",
      "statmc:sigma_s=3",
      "statmc:sigma_a=0.2",
      "statmc:sigma_n=0.01",
      "statmc:level=0.1",
      "sure-atrous:levels=2",
      "sure-atrous:mode=literal",
      "sure-atrous:weights=grid",
      "sure-atrous:window=0",
      "sure-atrous:sigma_n=1",
      "sure-atrous:sigma_x=1",
      "sure-atrous:sigma_y=3",
      "sure-atrous:distance=depth",
      "sure-atrous:distance=depth,sigma_z=3",
      "sure-atrous:variance=spatial",
      "fdf:radius=3",
      "fdf:t_max=1",
      "fdf:n_max=0.01",
      "fdf:s_max=0.5",
      "fdf:light=4",
      "fdf:prefilter_radius=2",
      "fdf:prefilter_patch=1",
      "fdf:epsilon=0.1",
      "fdf:guides=prefiltered",
      "nlm:radius=3",
      "nlm:radius=3,patch=1",
      "nlm:radius=3,k=1",
      "nlm:radius=3,alpha=0.5",
      "nlm:radius=3,threshold=0.2",
      "nlm:radius=3,cut=soft",
      "nlm:radius=3,epsilon=0.01",
      "nlm:mode=prefilter,radius=2,patch=1",
      "nlm:mode=prefilter,patch_mode=exp_of_mean,radius=2,k=1",
      "nlm:mode=prefilter,epsilon=0.01",
      // With one k: of two, fireflies in small windows leave the choice to rounding.
      "nfor:depth_scale=10,window=3,k_narrow=1",
      "nfor:depth_scale=10,window=3,k_narrow=0.2,k_wide=0.2",
      "nfor:depth_scale=10,window=3,k_narrow=3,k_wide=3",
      "nfor:depth_scale=10,window=3,k_narrow=1,k_final=0.3",
      "nfor:depth_scale=10,window=3,k_narrow=1,ridge=1",
      "nfor:depth_scale=20,window=3,k_narrow=1",
      "rdfc:depth_scale=10,window=3",
      "rdfc:depth_scale=10,k_c=1",
      "rdfc:depth_scale=10,k_f=2",
      "rdfc:depth_scale=10,tau=0.1",
      "rdfc:depth_scale=10,tau_features=0.1",
      "rdfc:depth_scale=20",
      "svgf:levels=2",
      "svgf:sigma_z=3",
      "svgf:sigma_n=1",
      "svgf:sigma_l=0.5",
  };
  for (const std::string_view text : texts) compare_variant(text);
  // Where the variance steers the edges, see filter_cases().
  for (const std::string_view text : {"sure-atrous:edge=svgf", "sure-atrous:edge=svgf,sigma_l=1"})
    compare_variant({.text = text, .of_extremes = {.share = 0.01, .of_largest = 1}}, parse_filter(text));
}

TEST_F(AgainstReference, PicturesOfOnePixelOneRowAndOneColumnAreFiltered) {
  for (const FilterCase& c : filter_cases())
    for (const Region& region : {Region{0, 0, 1, 1}, Region{3, 9, 50, 10}, Region{7, 0, 8, 41}})
      compare(c, parse_filter(c.text), region);
}

}  // namespace
}  // namespace tessera
