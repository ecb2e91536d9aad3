// SPDX-License-Identifier: Apache-2.0
// What is true of every filter with history.
#include <cmath>
#include <limits>
#include <random>

#include "core/filter/history.h"
#include "tests/worker/denoise/denoise_test.h"

namespace tessera {
namespace {

class Histories : public OnDevice {
 protected:
  static std::vector<FilterCase> cases() {
    std::vector<FilterCase> all;
    for (const FilterCase& c : filter_cases())
      if (parse_filter(c.text).history() > 0) all.push_back(c);
    return all;
  }
  static Image kept(const FilterPlan& plan, const Image& output) {
    return planes_of(output, 3, plan.history());
  }

  // What the pixels of `area` take from.
  static Region seen(const FilterPlan& plan, const Image& input, const Region& area) {
    return footprint(planes_of(input, plane_of(plan, Aov::motion, 0), 2), area, input.region());
  }
  static Image part(const Image& history, const Region& region) {
    return history.empty() || region.empty() ? Image{} : cropped(history, region);
  }
  Image stitched(const FilterPlan& plan, const Image& input, const Image& history, Size size) {
    Image whole(input.region(), 3 + plan.history());
    for (const Tile& tile : tiles_over(input.region(), size, plan.halo()))
      paste(whole, filter(*device_, plan, cropped(input, tile.outer), tile, input.region(),
                          touched(history, planes_of(input, plane_of(plan, Aov::motion, 0), 2), tile.outer,
                                  input.region())));
    return whole;
  }
  // Of every frame of the shot what is kept of the one before; the first has none.
  std::vector<Image> histories(const FilterPlan& plan, const std::vector<Image>& shot) {
    std::vector<Image> all(1);
    for (const Image& input : shot) all.push_back(kept(plan, filtered_and_kept(plan, input, all.back())));
    return all;
  }
};

std::vector<Image> made_up_shot(const FilterPlan& plan, const Region& region, std::string_view kind,
                                unsigned frames) {
  std::vector<Image> shot;
  for (unsigned frame = 1; frame <= frames; ++frame) shot.push_back(made_up_input(plan, region, kind, frame));
  return shot;
}

// One surface that rests: everything is found where it was.
void let_rest(Image& input, const FilterPlan& plan) {
  const std::vector<Channel> inputs = plan.inputs();
  for (int k = 0; k < input.planes(); ++k) {
    const auto set = [&](float v) { std::ranges::fill(input.plane(k), v); };
    if (inputs[k].statistic != Statistic::mean) continue;
    const bool z = inputs[k].index == 2;
    switch (inputs[k].aov) {
      case Aov::motion:
      case Aov::depth_gradient:
        set(0);
        break;
      case Aov::depth:
      case Aov::previous_depth:
        set(4);
        break;
      case Aov::normal:
      case Aov::geometric_normal:
        set(z ? 1.0f : 0.0f);
        break;
      case Aov::object_id:
      case Aov::material_id:
      case Aov::albedo:
        set(1);
        break;
      case Aov::emission:
        set(0);
        break;
      case Aov::position:
        for (int y = input.region().y0; y < input.region().y1; ++y)
          for (int x = input.region().x0; x < input.region().x1; ++x)
            input.at(k, x, y) = z ? -4.0f : 0.01f * static_cast<float>(inputs[k].index == 0 ? x : y);
        break;
      default:
        break;
    }
  }
}

TEST_F(Histories, OfTilesWithTheirFootprintsEqualThoseOfTheWholeFrameBitForBit) {
  for (const FilterCase& c : cases())
    for (const std::string_view kind : {"noise", "sky"}) {
      const FilterPlan plan = parse_filter(c.text);
      const Region frame = c.slow ? Region{-9, 4, 52, 51} : Region{-9, 4, 96, 78};
      Image history;
      for (unsigned number = 1; number <= 3; ++number) {
        const Image input = made_up_input(plan, frame, kind, number);
        const Image whole = filtered_and_kept(plan, input, history);
        for (const Size size : {Size{16, 16}, Size{37, 53}, Size{64, 64}})
          ASSERT_TRUE(same_bits(stitched(plan, input, history, size), whole))
              << c.text << " on frame " << number << " of " << kind << " in tiles of " << size.width;
        history = kept(plan, whole);
      }
    }
}

TEST_F(Histories, OfTilesOfOnePixelEqualThoseOfTheWholeFrameBitForBit) {
  for (const FilterCase& c : cases()) {
    const FilterPlan plan = parse_filter(c.text);
    const Region frame =
        c.slow ? Region{0, 0, 7, 6} : Region{20, 25, 39, 42};  // across the edge of two surfaces
    Image history;
    for (unsigned number = 1; number <= 3; ++number) {
      const Image input = made_up_input(plan, frame, "sky", number);
      const Image whole = filtered_and_kept(plan, input, history);
      ASSERT_TRUE(same_bits(stitched(plan, input, history, {1, 1}), whole))
          << c.text << " on frame " << number;
      history = kept(plan, whole);
    }
  }
}

// Each pixel of one of four surfaces, so that often none of four taps is of the right one.
void mix_surfaces(Image& input, const FilterPlan& plan, unsigned seed) {
  std::minstd_rand random(seed);
  const std::vector<Channel> inputs = plan.inputs();
  for (int y = input.region().y0; y < input.region().y1; ++y)
    for (int x = input.region().x0; x < input.region().x1; ++x) {
      const int surface = static_cast<int>(random() >> 8) & 3;
      for (int k = 0; k < input.planes(); ++k) {
        const Aov a = inputs[k].aov;
        if (a == Aov::object_id || a == Aov::material_id) input.at(k, x, y) = static_cast<float>(1 + surface);
        if (a == Aov::normal || a == Aov::geometric_normal)
          input.at(k, x, y) = surface == 3 ? (inputs[k].index == 0 ? -1.0f : 0.0f)
                                           : (inputs[k].index == surface ? 1.0f : 0.0f);
      }
    }
}

void pan(Image& input, const FilterPlan& plan, float x, float y) {
  std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 0)), x);
  std::ranges::fill(input.plane(plane_of(plan, Aov::motion, 1)), y);
}

TEST_F(Histories, WithoutTheFootprintsFirstOrLastRowOrColumnDiffer) {
  const Region frame{0, 0, 40, 36};
  for (const FilterCase& c : cases()) {
    if (!c.wide_past) continue;
    const FilterPlan plan = parse_filter(c.text);
    Image input = made_up_input(plan, frame, "noise");
    let_rest(input, plan);
    mix_surfaces(input, plan, 1);
    const Image history = kept(plan, filtered_and_kept(plan, input));
    mix_surfaces(input, plan, 2);
    int caught[4] = {};
    for (const float by : {5.5f, -5.4f}) {
      pan(input, plan, by, by);
      const Region box = seen(plan, input, frame);
      const Image whole = filtered_and_kept(plan, input, history);
      EXPECT_TRUE(same_bits(filtered_and_kept(plan, input, cropped(history, box)), whole)) << c.text;
      const Region smaller[] = {{box.x0 + 1, box.y0, box.x1, box.y1},
                                {box.x0, box.y0 + 1, box.x1, box.y1},
                                {box.x0, box.y0, box.x1 - 1, box.y1},
                                {box.x0, box.y0, box.x1, box.y1 - 1}};
      for (int side = 0; side < 4; ++side) {
        const int edge[] = {box.x0, box.y0, frame.x1 - box.x1, frame.y1 - box.y1};
        if (edge[side] == 0) continue;  // the frame's own border
        caught[side] += !same_bits(filtered_and_kept(plan, input, cropped(history, smaller[side])), whole);
      }
    }
    for (int side = 0; side < 4; ++side) EXPECT_EQ(caught[side], 1) << c.text << ", side " << side;
  }
}

TEST_F(Histories, ThatAreMissingMakeAFirstFrameWhateverWasFilteredBefore) {
  for (const FilterCase& c : cases()) {
    const FilterPlan plan = parse_filter(c.text);
    const std::vector<Image> shot = made_up_shot(plan, {0, 0, 61, 47}, "noise", 3);
    const Image first = filtered_and_kept(plan, shot[2]);
    const std::vector<Image> before = histories(plan, shot);
    EXPECT_FALSE(same_bits(filtered_and_kept(plan, shot[2], before[2]), first)) << c.text;
    EXPECT_TRUE(same_bits(filtered_and_kept(plan, shot[2]), first)) << c.text;
  }
}

TEST_F(Histories, OfAFirstFrameChangeNothingButWhatIsKept) {
  for (const auto& [with, without] :
       {std::pair{"svgf:history=on", "svgf"}, std::pair{"atrous:history=on", "atrous"},
        std::pair{"svgf:history=on,variance=spatial", "svgf:variance=spatial"}}) {
    const FilterPlan plan = parse_filter(with), plain = parse_filter(without);
    const Image input = made_up_input(plan, {0, 0, 61, 47}, "sky");
    const Image same = planes_of(input, 0, static_cast<int>(plain.inputs().size()));
    EXPECT_TRUE(same_bits(filtered(plan, input), filtered(plain, same))) << with;
  }
}

TEST_F(Histories, LeaveNoGhostOfWhatCannotBeSeenAnyMore) {
  const Region frame{0, 0, 61, 47};
  for (const FilterCase& c : cases()) {
    const FilterPlan plan = without_history(parse_filter(c.text));  // the same, be there a history or none
    const Image history = kept(plan, filtered_and_kept(plan, made_up_input(plan, frame, "firefly")));
    Image input = made_up_input(plan, frame, "noise", 2);
    for (const float away : {1e4f, -64.0f, kSkyDepth, std::numeric_limits<float>::quiet_NaN()}) {
      pan(input, plan, away, 1);
      EXPECT_TRUE(same_bits(filtered_and_kept(plan, input, history), filtered_and_kept(plan, input)))
          << c.text << ", moved by " << away;
    }
  }
}

TEST_F(Histories, ThatAreNoNumbersAreNone) {
  const Region frame{0, 0, 61, 47};
  for (const FilterCase& c : cases()) {
    if (c.taa) continue;  // of two histories one is left
    const FilterPlan plan = without_history(parse_filter(c.text));  // the same, be there a history or none
    const Image input = made_up_input(plan, frame, "noise", 2), first = filtered_and_kept(plan, input);
    const Image good = kept(plan, filtered_and_kept(plan, made_up_input(plan, frame, "noise", 1)));
    for (const float bad : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(),
                            -std::numeric_limits<float>::infinity()})
      for (int p = 0; p < plan.history(); ++p) {
        Image history = good;
        std::ranges::fill(history.plane(p), bad);
        EXPECT_TRUE(same_bits(filtered_and_kept(plan, input, history), first)) << c.text << ", plane " << p;
        history = good;
        for (std::size_t k = p; k < history.plane(p).size(); k += 7) history.plane(p)[k] = bad;
        const Image partly = filtered_and_kept(plan, input, history);
        EXPECT_FALSE(same_bits(partly, first)) << c.text << ", plane " << p;
        for (const float v : partly.data()) ASSERT_TRUE(std::isfinite(v)) << c.text << ", plane " << p;
      }
  }
}

TEST_F(Histories, DoNotKnowTheSky) {
  const Region frame{0, 0, 61, 47};
  for (const FilterCase& c : cases()) {
    if (c.taa) continue;  // which mixes skies too
    const FilterPlan plan = parse_filter(c.text);
    Image input = made_up_input(plan, frame, "noise");
    let_rest(input, plan);
    Image sky = input, brighter = input;
    for (int y = 0; y < 20; ++y)
      for (int x = 10; x < 30; ++x) {
        put_sky(sky, plan, x, y, 1);
        put_sky(brighter, plan, x, y, 1e6f);
      }
    const Image dark = kept(plan, filtered_and_kept(plan, sky)),
                bright = kept(plan, filtered_and_kept(plan, brighter));
    EXPECT_TRUE(same_bits(dark, bright)) << c.text;
    const Image after = filtered_and_kept(plan, input, dark);
    const Image sky_again =
        planes_of(filtered_and_kept(plan, brighter, kept(plan, filtered_and_kept(plan, input))), 0, 3);
    EXPECT_EQ(sky_again.at(0, 20, 10), 1e6f) << c.text;
    for (const float v : after.data()) ASSERT_TRUE(std::isfinite(v)) << c.text;
  }
}

// What svgf and atrous keep of light as they accumulate it.
constexpr std::string_view kAccumulating[] = {"svgf:history=on,feedback=0", "atrous:history=on",
                                              "svgf:history=on,feedback=0,average=exponential",
                                              "svgf:history=on,feedback=0,alpha=0.05"};

TEST_F(Histories, OfASceneAtRestAverageItsFramesByTheirWeights) {
  constexpr int kFrames = 40;
  for (const std::string_view text : kAccumulating) {
    const FilterPlan plan = parse_filter(text);
    const Region frame{0, 0, 160, 160};
    std::mt19937 random(20170728);
    std::normal_distribution<float> noise(2, 1);
    Image history;
    double factor = 1;
    for (int number = 1; number <= kFrames; ++number) {
      Image input = made_up_input(plan, frame, "constant");
      let_rest(input, plan);
      for (float& v : input.plane(plane_of(plan, light_of(plan), 1))) v = noise(random);
      history = kept(plan, filtered_and_kept(plan, input, history));
      const double a = number == 1                   ? 1
                       : plan.is("average", "plain") ? std::max(plan["alpha"], 1.0 / number)
                                                     : plan["alpha"];
      factor = a * a + (1 - a) * (1 - a) * factor;
      const auto light = history.plane(light_of(plan) == Aov::color ? 1 : 4);
      double sum = 0, squares = 0;
      for (const float v : light) sum += v, squares += double(v) * v;
      const double count = static_cast<double>(light.size()), mean = sum / count;
      EXPECT_NEAR(mean, 2, 5 * std::sqrt(factor / count)) << text << " after " << number << " frames";
      EXPECT_NEAR(squares / count - mean * mean, factor, 5 * factor * std::sqrt(2 / count)) << text;
    }
  }
}

TEST_F(Histories, FollowWhatMovesByWholePixelsBitForBit) {
  for (const std::string_view text : kAccumulating) {
    const FilterPlan plan = parse_filter(text);
    const Region wide{0, 0, 90, 70}, first{20, 10, 80, 60}, second{17, 12, 77, 62};
    Image scene = made_up_input(plan, wide, "noise");
    let_rest(scene, plan);
    const auto shown = [&](const Region& r) {
      return Image({0, 0, 60, 50}, scene.planes(), [&] {
        const Image part = cropped(scene, r);
        return Floats(part.data().begin(), part.data().end());
      }());
    };
    const Image history = kept(plan, filtered_and_kept(plan, shown(first)));
    Image input = shown(second);
    pan(input, plan, 3, -2);
    const Image alone = filtered_and_kept(plan, input), after = filtered_and_kept(plan, input, history);
    const int lights = light_of(plan) == Aov::color ? 3 : 6;
    const auto found = [&](const Image& output) {
      return planes_of(cropped(output, {3, 0, 60, 48}), 3, lights);
    };
    EXPECT_TRUE(same_bits(found(after), found(alone))) << text;
    EXPECT_FALSE(same_bits(after, alone)) << text << ": it is found";
  }
}

// What the parameters change shows in the second frame.
TEST_F(Histories, DependOnTheirParameters) {
  for (const auto& [plain, other] : {std::pair{"atrous:history=on", "atrous:history=on,alpha=0.7"},
                                     std::pair{"atrous:history=on", "atrous:history=on,average=exponential"},
                                     std::pair{"svgf:history=on", "svgf:history=on,alpha=0.7"},
                                     std::pair{"svgf:history=on", "svgf:history=on,average=exponential"},
                                     std::pair{"svgf:history=on", "svgf:history=on,feedback=3"},
                                     std::pair{"svgf:history=on,variance=spatial",
                                               "svgf:history=on,variance=spatial,alpha_moments=0.6"}}) {
    const auto third = [&](std::string_view text) {
      const FilterPlan plan = parse_filter(text);
      const std::vector<Image> shot = made_up_shot(plan, {0, 0, 61, 47}, "noise", 3);
      return filtered_and_kept(plan, shot[2], histories(plan, shot)[2]);
    };
    EXPECT_FALSE(same_bits(third(plain), third(other))) << other;
  }
}

}  // namespace
}  // namespace tessera
