// SPDX-License-Identifier: Apache-2.0
// What filters that go over frames take from files.
#include <gmock/gmock.h>

#include <limits>

#include "core/error.h"
#include "tests/core/filter/made_files.h"

namespace tessera {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

class GatherOfShots : public testing::Test {
 protected:
  // All that the filter takes, but for what is named.
  ExrImage picture_without(const std::vector<std::string>& layers) const {
    std::vector<std::string> names;
    for (const Channel& c : plan_.inputs()) {
      const std::string name = file_channel(c);
      if (std::ranges::find(layers, name.substr(0, name.rfind('.'))) == layers.end()) names.push_back(name);
    }
    return file(names);
  }
  Gathered gather_of(const ExrImage& picture, const Sources& how = {}) {
    Sources sources = how;
    sources.picture = &picture;
    return gather(plan_, sources, "picture.exr");
  }
  std::string refusal(const ExrImage& picture, const Sources& how = {}) {
    try {
      gather_of(picture, how);
    } catch (const InputError& e) {
      return e.what();
    }
    return "";
  }
  std::span<float> plane(ExrImage& image, const Channel& c) {
    return image.pixels.plane(image.plane(file_channel(c)));
  }

  FilterPlan plan_ = parse_filter("svgf:history=on");
};

TEST_F(GatherOfShots, RefusesToGuessMotionUnlessNothingMoves) {
  const ExrImage picture = picture_without({"motion"});
  EXPECT_THAT(refusal(picture), HasSubstr("motion.XY (or Vector.XY; Vector.RG)"));
  EXPECT_THAT(refusal(picture), HasSubstr("--guide motion=FILE, or --static, if nothing moves"));
  const Gathered still = gather_of(picture, {.resting = true});
  EXPECT_EQ(first_of(plan_, still.input, {Aov::motion, 1}), 0);
  Sources backwards;
  backwards.backwards = true;
  EXPECT_THAT(refusal(picture_without({}), backwards), HasSubstr("next_motion.XY (or Vector.ZW; Vector.BA)"));
}

TEST_F(GatherOfShots, ScalesMotionAsToldAndThenTakesThatOfUnknownUnitsToo) {
  ExrImage picture = picture_without({"motion"});
  picture.channels[0].name = "motionvector.R";
  picture.channels[1].name = "motionvector.G";
  picture.channels.push_back({"direct.R", ExrType::float32});
  picture.channels.push_back({"direct.G", ExrType::float32});
  picture.pixels = Image(kRegion, static_cast<int>(picture.channels.size()), 3.0f);
  EXPECT_THAT(refusal(picture), HasSubstr("--motion-scale, which says how to read motionvector.R"));
  Sources scaled;
  scaled.motion_scale = {{-2, 0.5f}};
  const Gathered g = gather_of(picture, scaled);
  EXPECT_EQ(first_of(plan_, g.input, {Aov::motion, 0}), -6);
  EXPECT_EQ(first_of(plan_, g.input, {Aov::motion, 1}), 1.5f);
}

TEST_F(GatherOfShots, TurnsTimeAroundForAFilterThatGoesBackwards) {
  ExrImage picture = picture_without({"motion", "previous"});
  for (const char* name : {"next_motion.X", "next_motion.Y", "next.Z"})
    picture.channels.push_back({name, ExrType::float32});
  picture.pixels = Image(kRegion, static_cast<int>(picture.channels.size()));
  std::ranges::fill(plane(picture, {Aov::next_motion, 0}), 4.0f);
  std::ranges::fill(plane(picture, {Aov::next_motion, 1}), -1.0f);
  std::ranges::fill(plane(picture, {Aov::next_depth, 0}), 7.0f);
  Sources backwards;
  backwards.backwards = true;
  const Gathered g = gather_of(picture, backwards);
  EXPECT_EQ(first_of(plan_, g.input, {Aov::motion, 0}), -4) << "so that p - motion is where it will be";
  EXPECT_EQ(first_of(plan_, g.input, {Aov::motion, 1}), 1);
  EXPECT_EQ(first_of(plan_, g.input, {Aov::previous_depth, 0}), 7);
  EXPECT_THAT(g.notices, IsEmpty());
}

TEST_F(GatherOfShots, SaysWhatStandsInForWhatTellsSurfacesApart) {
  ExrImage picture = picture_without({"previous", "Ng", "object_id", "depth_gradient"});
  for (int x = kRegion.x0; x < kRegion.x1; ++x)
    for (int y = kRegion.y0; y < kRegion.y1; ++y)
      picture.pixels.at(picture.plane("Z"), x, y) = x < 5 ? 10 + 0.5f * float(x) + 2 * float(y) : 1e10f;
  const Gathered g = gather_of(picture);
  EXPECT_THAT(g.notices,
              testing::UnorderedElementsAre(
                  HasSubstr("no layer previous: surfaces count as having been as deep as they are"),
                  HasSubstr("no layer Ng: the shading normals"),
                  HasSubstr("no layer object_id: all surfaces count as one"),
                  HasSubstr("no layer depth_gradient: it is the difference")));
  EXPECT_EQ(first_of(plan_, g.input, {Aov::previous_depth, 0}), first_of(plan_, g.input, {Aov::depth, 0}));
  for (int c = 0; c < 3; ++c)
    EXPECT_EQ(first_of(plan_, g.input, {Aov::geometric_normal, c}),
              first_of(plan_, g.input, {Aov::normal, c}));
  EXPECT_EQ(first_of(plan_, g.input, {Aov::object_id, 0}), 0);
  const std::vector<Channel> inputs = plan_.inputs();
  const int slope =
      static_cast<int>(std::ranges::find(inputs, Channel{Aov::depth_gradient, 0}) - inputs.begin());
  for (const int x : {2, 4}) {
    EXPECT_EQ(g.input.at(slope, x, 4), 0.5f) << "also beside the sky";
    EXPECT_EQ(g.input.at(slope + 1, x, 4), 2);
  }
  EXPECT_EQ(g.input.at(slope, 6, 4), 0) << "the sky has none";
}

TEST_F(GatherOfShots, LeadsBrokenMotionNowhereAndCountsIt) {
  ExrImage picture = picture_without({});
  const std::span<float> x = plane(picture, {Aov::motion, 0}), y = plane(picture, {Aov::motion, 1});
  x[3] = std::numeric_limits<float>::quiet_NaN();
  y[4] = -std::numeric_limits<float>::infinity();
  x[5] = 2e6f;
  x[6] = y[6] = kSkyDepth;  // what was behind the camera: no defect
  const Gathered g = gather_of(picture);
  EXPECT_THAT(g.defects,
              ElementsAre("motion: 3 of 35 pixels lead nowhere, the first at (5, 3): they start anew"));
  const std::vector<Channel> inputs = plan_.inputs();
  const int plane = static_cast<int>(std::ranges::find(inputs, Channel{Aov::motion, 0}) - inputs.begin());
  for (const int c : {0, 1}) {
    EXPECT_THAT(g.input.plane(plane + c).subspan(3, 4), Each(kSkyDepth));
    EXPECT_NE(g.input.plane(plane + c)[2], kSkyDepth);
    EXPECT_NE(g.input.plane(plane + c)[7], kSkyDepth);
  }
}

}  // namespace
}  // namespace tessera
