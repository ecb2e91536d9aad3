// SPDX-License-Identifier: Apache-2.0
// No seam: what a tile yields is what the whole frame yields, bit for bit.
#include <thread>
#include <vector>

#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Tiles : public OnDevice {
 protected:
  struct Text {
    std::string_view text;
    bool slow;
  };
  static std::vector<Text> texts() {
    std::vector<Text> all;
    for (const FilterCase& c : filter_cases()) all.push_back({c.text, c.slow});
    return all;
  }
};

TEST_F(Tiles, OfAnySizeEqualTheWholeFrameBitForBit) {
  const std::vector<Size> odd{{37, 53}}, many{{16, 16}, {37, 53}, {64, 64}, {128, 128}, {203, 5}};
  for (const auto& [text, slow] : texts())
    for (const std::string_view kind : {"noise", "sky", "firefly"}) {
      const Region frame = slow ? Region{0, 0, 101, 83} : Region{0, 0, 203, 149};
      const FilterPlan plan = parse_filter(text);
      const Image input = made_up_input(plan, frame, kind);
      const Image whole = filtered(plan, input);
      for (const Size size : kind == "sky" ? many : odd)
        ASSERT_TRUE(same_bits(stitched(plan, input, size), whole))
            << text << " on " << kind << " in tiles of " << size.width << "x" << size.height;
    }
}

TEST_F(Tiles, OfOnePixelEqualTheWholeFrameBitForBit) {
  for (const auto& [text, slow] : texts()) {
    const Region frame = slow ? Region{0, 0, 7, 6} : Region{0, 0, 19, 23};
    const FilterPlan plan = parse_filter(text);
    const Image input = made_up_input(plan, frame, "sky");
    EXPECT_TRUE(same_bits(stitched(plan, input, {1, 1}), filtered(plan, input))) << text;
  }
}

TEST_F(Tiles, OfACropAnywhereInTheGridEqualTheWholeCropBitForBit) {
  for (const Region& crop : {Region{13, 41, 180, 141}, Region{-70, -35, 31, 28}, Region{1000, 3, 1009, 160}})
    for (const auto& [text, slow] : texts()) {
      if (slow && crop.x0 != 13) continue;
      const FilterPlan plan = parse_filter(text);
      const Image input = made_up_input(plan, crop, "noise");
      EXPECT_TRUE(same_bits(stitched(plan, input, {48, 40}), filtered(plan, input)))
          << text << " at " << crop.x0;
    }
}

TEST_F(Tiles, WithOnePixelLessHaloDiffer) {
  // SVGF's levels read the variance only next to their centre, so its window's last pixel counts one pixel
  // less far out than the colour's: of svgf's halo one pixel is to spare. The variance by which sure-atrous
  // weighs its details comes as far as they do.
  struct Case {
    std::string_view filter;
    int spare = 0;
  };
  constexpr Case cases[] = {
      {"atrous"},
      {"atrous:levels=2"},
      {"atrous:levels=4"},
      {"bilateral"},
      {"bmfr:frame=10"},
      {"bmfr:grids=1,frame=10"},
      {"bmfr:block=8,frame=6"},
      {"box"},
      {"cross-bilateral:width=11"},
      {"ddf:diameter=100"},
      {"ddf:diameter=100,holes=on,kw=15"},
      {"gaussian:sigma=1.7"},
      {"guided"},
      {"guided:radius=3"},
      {"rhf"},
      {"rhf:patch=0,radius=4"},
      {"rhf:patch=2,average=patches"},
      {"statmc"},
      {"statmc:radius=4"},
      {"sure-atrous:levels=3,sigma_y=100"},
      {"sure-atrous:levels=2,window=3,distance=depth,sigma_y=100"},
      {"sure-atrous:levels=1,window=1,sigma_y=10,variance=spatial"},
      {"sure-atrous:mode=literal,edge=svgf"},
      {"fdf:t_max=1,n_max=1"},
      {"fdf:radius=2,prefilter_radius=2,t_max=1,n_max=1"},
      {"nlm"},
      {"nlm:radius=2,patch=1"},
      {"nlm:mode=prefilter"},
      {"nlm:mode=prefilter,patch_mode=exp_of_mean"},
      {"svgf:levels=1", 1},
      {"svgf:levels=1,variance=spatial", 1},
      {"svgf:levels=3", 1},
      {"svgf:sigma_z=100,sigma_n=1,sigma_l=1", 1},
  };
  const Region frame{-64, -64, 156, 146}, inner{26, 21, 66, 61};
  for (const auto& [text, spare] : cases) {
    const FilterPlan plan = parse_filter(text);
    const Region needed = grown(inner, plan.halo());
    int caught =
        0;  // five levels away a single pixel's variance need not reach the last bit of every picture
    for (unsigned seed = 0; seed < 8; ++seed) {
      const Image input = made_up_input(plan, frame, "noise", seed);
      const Image whole = cropped(filtered(plan, input), inner);
      // What lies beyond `seen` does not exist for the filter.
      const auto with_halo = [&](int halo) {
        const Region seen = grown(inner, halo);
        return filter(*device_, plan, cropped(input, seen), {inner, seen}, intersect(needed, seen));
      };
      EXPECT_TRUE(same_bits(with_halo(plan.halo()), whole)) << text << ", seed " << seed;
      EXPECT_TRUE(same_bits(with_halo(plan.halo() - spare), whole)) << text << ", seed " << seed;
      caught += !same_bits(with_halo(plan.halo() - spare - 1), whole);
    }
    EXPECT_GT(caught, 0) << text;
    RecordProperty(std::string(text), caught);
  }
}

TEST_F(Tiles, DoNotDependOnWhatTheDeviceDidBefore) {
  const FilterPlan svgf = parse_filter("svgf"), atrous = parse_filter("atrous");
  const Region large{0, 0, 120, 90}, small{0, 0, 33, 21};
  const Image a = made_up_input(svgf, large, "extreme"), b = made_up_input(svgf, small, "noise");
  const Image first = filtered(svgf, b);
  filtered(svgf, a);
  filtered(atrous, made_up_input(atrous, small, "extreme"));
  EXPECT_TRUE(same_bits(filtered(svgf, b), first));
  filtered(svgf, made_up_input(svgf, small, "extreme"));
  EXPECT_TRUE(same_bits(filtered(svgf, b), first));
  const FilterPlan shallow = parse_filter("svgf:levels=1");  // the same planes, otherwise padded
  filtered(shallow, made_up_input(shallow, small, "noise"));
  EXPECT_TRUE(same_bits(filtered(svgf, b), first));
}

TEST_F(Tiles, DoNotDependOnWhichFilterRanBefore) {
  const Region region{0, 0, 90, 30};
  std::vector<Image> results;
  for (const FilterCase& c : filter_cases()) {
    const FilterPlan plan = parse_filter(c.text);
    results.push_back(filtered(plan, made_up_input(plan, region, "noise")));
  }
  for (std::size_t k = results.size(); k-- > 0;) {
    const FilterPlan plan = parse_filter(filter_cases()[k].text);
    EXPECT_TRUE(same_bits(filtered(plan, made_up_input(plan, region, "noise")), results[k])) << plan.name;
  }
}

TEST_F(Tiles, FilteredByTwoThreadsOnOneDeviceAreTheSame) {
  const FilterPlan plan = parse_filter("svgf");
  const Image input = made_up_input(plan, {0, 0, 64, 48}, "noise");
  const Image expected = filtered(plan, input);
  std::vector<Image> results(8);
  std::vector<std::jthread> threads;
  for (int t = 0; t < 2; ++t)
    threads.emplace_back([&, t] {
      for (std::size_t i = t; i < results.size(); i += 2) results[i] = filtered(plan, input);
    });
  threads.clear();
  for (const Image& result : results) EXPECT_TRUE(same_bits(result, expected));
}

TEST_F(Tiles, WhoseOuterRegionIsNotWhatTheHaloNeedsAreRefused) {
  const FilterPlan plan = parse_filter("atrous:levels=1");
  const Region frame{0, 0, 40, 40}, inner{10, 10, 20, 20}, outer = grown(inner, 2);
  const Image input = made_up_input(plan, outer, "noise");
  EXPECT_NO_THROW(filter(*device_, plan, input, {inner, outer}, frame));
  EXPECT_THROW(filter(*device_, plan, input, {inner, inner}, frame), Error);
  EXPECT_THROW(filter(*device_, plan, input, {{10, 10, 10, 20}, outer}, frame), Error);
  EXPECT_THROW(filter(*device_, plan, cropped(input, inner), {inner, outer}, frame), Error);
  EXPECT_THROW(filter(*device_, plan, Image(outer, 3), {inner, outer}, frame), Error);
}

TEST_F(Tiles, OfATaskAreTheFilteredStatisticsOfAllSamplesAndOfBothHalves) {
  const Region frame{0, 0, 30, 20};
  const Tile tile{{4, 4, 12, 15}, {0, 0, 30, 20}};
  for (const std::string_view text : {"none", "atrous:levels=4", "svgf:levels=4"}) {
    const FilterPlan plan = parse_filter(text);
    const std::vector<Channel> inputs = plan.inputs();
    const FilmLayout layout(aovs_of(inputs));
    const Tile cut{tile.inner, intersect(grown(tile.inner, plan.halo()), frame)};
    Image sums(cut.outer, layout.planes());
    for (int p = 0; p < layout.planes(); ++p)
      for (std::size_t i = 0; i < sums.plane(p).size(); ++i)
        sums.plane(p)[i] = p < 4 ? 8.0f : static_cast<float>((i * 31 + p * 17) % 101) * (p % 2 ? 0.1f : 0.2f);
    const Filtered result = filter_task(*device_, plan, sums, layout, cut, frame);
    ASSERT_EQ(result.planes(), kFilteredPlanes);
    int plane = 0;
    for (const Part part : {Part::all, Part::a, Part::b}) {
      const Image expected = filter(*device_, plan, developed(sums, layout, inputs, part), cut, frame);
      for (int k = 0; k < 3; ++k, ++plane)
        EXPECT_TRUE(std::ranges::equal(result.plane(plane), expected.plane(k))) << text << " plane " << plane;
    }
  }
}

}  // namespace
}  // namespace tessera
