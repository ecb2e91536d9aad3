// SPDX-License-Identifier: Apache-2.0
// Which plane of a file a filter gets, where the names leave room for another one.
#include <gmock/gmock.h>

#include <cmath>
#include <limits>

#include "core/error.h"
#include "tests/core/filter/made_files.h"

namespace tessera {
namespace {

using testing::Contains;
using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

const std::vector<std::string> kGuided{"B", "G",        "N.X",      "N.Y",     "N.Z",
                                       "R", "albedo.B", "albedo.G", "albedo.R"};

std::vector<std::string> and_also(std::vector<std::string> names, const std::vector<std::string>& more) {
  names.insert(names.end(), more.begin(), more.end());
  return names;
}

std::string refusal_of(const FilterPlan& plan, const Sources& sources) {
  try {
    gather(plan, sources, "picture.exr");
  } catch (const InputError& error) {
    return error.what();
  }
  return {};
}

TEST(Layers, APicturesRedIsNoDepth) {
  EXPECT_EQ(plane_of(file({"B", "Depth.Z", "G", "R"}), {Aov::depth, 0}), 1);
  EXPECT_EQ(plane_of(file({"B", "G", "R", "ViewLayer.Depth.Z"}), {Aov::depth, 0}), 3);
  EXPECT_EQ(plane_of(file({"B", "G", "R", "V", "X", "Y"}), {Aov::depth, 0}), -1);
  EXPECT_EQ(plane_of(file({"Depth.V"}), {Aov::depth, 0}), 0) << "in its layer it goes by any letter";
}

TEST(Gather, RefusesAPictureWithoutDepth) {
  const ExrImage picture = file(kGuided);
  EXPECT_THAT(refusal_of(parse_filter("svgf"), {&picture, {}, {}}), HasSubstr("takes Z (or Depth.Z"));
}

TEST(Gather, TakesTheVarianceOfThePictureForThatOfItsLightWhereAllOfItIsOne) {
  const ExrImage picture = file(and_also(kGuided, {"Z", "variance.B", "variance.G", "variance.R"}));
  const FilterPlan plan = parse_filter("svgf");
  const Gathered g = gather(plan, {&picture, {}, {}}, "picture.exr");
  EXPECT_EQ(first_of(plan, g.input, {Aov::direct, 0, Statistic::variance_of_mean}), 13);
  EXPECT_EQ(first_of(plan, g.input, {Aov::indirect, 0, Statistic::variance_of_mean}), 0);
  EXPECT_THAT(g.notices, Not(Contains(HasSubstr("estimated"))));
}

TEST(Gather, AFilterThatFindsTheVarianceItselfAsksForNone) {
  const ExrImage picture = file(and_also(kGuided, {"P.X", "P.Y", "P.Z", "Z"}));
  for (const char* filter : {"svgf:variance=spatial", "sure-atrous:variance=spatial"})
    EXPECT_THAT(gather(parse_filter(filter), {&picture, {}, {}}, "picture.exr").notices,
                Not(Contains(HasSubstr("variance"))))
        << filter;
}

// pbrt's is that of a sample.
TEST(Gather, DividesPbrtsVarianceByTheSamples) {
  const ExrImage picture = file({"B", "G", "R", "Variance.B", "Variance.G", "Variance.R"});
  const FilterPlan plan = parse_filter("nlm");
  Sources sources{&picture, {}, 8.0};
  const Channel half{Aov::color, 0, Statistic::variance_of_mean, Share::a};
  EXPECT_EQ(first_of(plan, gather(plan, sources, "picture.exr").input, half), 6.0f / 8);
  sources.samples = {};
  EXPECT_THAT(gather(plan, sources, "picture.exr").notices,
              Contains(HasSubstr("Variance is that of single samples")));
}

TEST(Gather, AFileOfOneLayerGoesByItsNameOrItsLettersAndByNoOther) {
  const ExrImage picture = file(and_also(kGuided, {"Z"}));
  const FilterPlan plan = parse_filter("cross-bilateral");
  Sources sources{&picture, {}, {}};
  const auto normal_of = [&](const std::vector<std::string>& names) {
    sources.separate.insert_or_assign("N", file(names));
    return first_of(plan, gather(plan, sources, "picture.exr").input, {Aov::normal, 0});
  };
  EXPECT_EQ(normal_of({"A", "B", "G", "R"}), 4);
  EXPECT_EQ(normal_of({"W", "X", "Y", "Z"}), 2);
  EXPECT_EQ(normal_of({"albedo.R", "N.X", "N.Y", "N.Z"}), 2);
  sources.separate.insert_or_assign("N", file({"albedo.R", "albedo.G", "albedo.B"}));
  EXPECT_THAT(refusal_of(plan, sources), HasSubstr("no such layer; there are: albedo.R, albedo.G, albedo.B"));
  sources.separate.insert_or_assign("N", file({"R"}));
  EXPECT_THAT(refusal_of(plan, sources), HasSubstr("no such layer; there are: R"));
  sources.separate.clear();
  sources.separate.emplace("Z", file({"anything"}));
  EXPECT_EQ(first_of(plan, gather(plan, sources, "picture.exr").input, {Aov::depth, 0}), 1);
}

TEST(Gather, ColoursOfWhichAChannelIsBrokenAreBrokenWholeAndDepthsThatAreNoNumberAreCounted) {
  ExrImage picture = file({"B", "G", "R", "Z", "N.X", "N.Y", "N.Z", "albedo.B", "albedo.G", "albedo.R"});
  const float none = std::numeric_limits<float>::quiet_NaN();
  picture.pixels.at(picture.plane("G"), 4, 5) = none;
  picture.pixels.at(picture.plane("Z"), 6, 7) = none;
  picture.pixels.at(picture.plane("Z"), 5, 5) = std::numeric_limits<float>::infinity();
  const Gathered g = gather(parse_filter("cross-bilateral"), {&picture, {}, {}}, "picture.exr");
  EXPECT_THAT(g.broken, ElementsAre("noisy.G: 1 pixel is not finite, the first at (4, 5)"));
  EXPECT_THAT(g.defects, ElementsAre(HasSubstr("Z: 1 of 35 pixels are no number, the first at (6, 7)")));
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isnan(g.input.at(c, 4, 5))) << c;
  for (int c = 0; c < 3; ++c) EXPECT_TRUE(std::isfinite(g.input.at(c, 5, 5))) << c;
}

TEST(FactsOf, AreThoseThatAreWrittenElseWhatIsSeenOfTheScene) {
  ExrImage picture = file(and_also(kGuided, {"P.X", "P.Y", "P.Z", "Z"}));
  picture.pixels.at(picture.plane("P.X"), 4, 5) += 3;
  picture.pixels.at(picture.plane("P.Z"), 4, 6) += 4;
  const FilterPlan plan = parse_filter("guided");
  ASSERT_TRUE(asks_for_scene(plan));
  const Sources sources{&picture, {}, {}};
  const Image input = gather(plan, sources, "picture.exr").input;
  FoundFacts found = facts_of(plan, input, sources);
  EXPECT_EQ(found.facts.diameter, 5);
  EXPECT_THAT(found.notices, ElementsAre(HasSubstr("how large the scene is: 5, by what P holds")));
  picture.metadata[kDiameterKey] = "0.1";
  picture.metadata[kLightKey] = "12.5";
  found = facts_of(plan, input, sources);
  EXPECT_EQ(found.facts, (SceneFacts{.diameter = 0.1, .light = 12.5}));
  EXPECT_THAT(found.notices, IsEmpty());
  for (const char* wrong : {"", "nan", "inf", "-1", "0", "1e999", "x"}) {
    picture.metadata[kDiameterKey] = wrong;
    EXPECT_EQ(facts_of(plan, input, sources).facts.diameter, 5) << wrong;
  }
}

TEST(FactsOf, SeeAFileOfItsOwnForP) {
  const ExrImage picture = file(and_also(kGuided, {"Z"}));
  ExrImage positions = file({"X", "Y", "Z"});
  positions.pixels.at(1, 4, 5) += 7;
  Sources sources{&picture, {}, {}};
  sources.separate.emplace("P", positions);
  const FilterPlan plan = parse_filter("guided");
  EXPECT_EQ(facts_of(plan, gather(plan, sources, "picture.exr").input, sources).facts.diameter, 7);
}

}  // namespace
}  // namespace tessera
