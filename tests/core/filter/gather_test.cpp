// SPDX-License-Identifier: Apache-2.0
#include "core/filter/gather.h"

#include <gmock/gmock.h>

#include <limits>
#include <random>

#include "core/error.h"
#include "core/filter/stand_ins.h"
#include "tests/core/filter/made_files.h"

namespace tessera {
namespace {

using testing::Each;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

Image gathered(const FilterPlan& plan, const ExrImage& picture, std::vector<std::string>* notices = nullptr) {
  Gathered g = gather(plan, {&picture, {}, {}}, "picture.exr");
  if (notices) *notices = g.notices;
  return g.input;
}

TEST(Layers, HaveTheNamesOfOurFiles) {
  EXPECT_EQ(file_channel({Aov::color, 0}), "noisy.R");
  EXPECT_EQ(file_channel({Aov::color, 2, Statistic::variance_of_mean}), "variance.B");
  EXPECT_EQ(file_channel({Aov::color, 1, Statistic::mean, Share::a}), "noisy_even.G");
  EXPECT_EQ(file_channel({Aov::normal, 1, Statistic::variance_of_mean}), "N_variance.Y");
  EXPECT_EQ(file_channel({Aov::depth, 0}), "Z");
  EXPECT_EQ(file_channel({Aov::depth, 0, Statistic::variance_of_mean}), "depth_variance.Z");
  EXPECT_EQ(file_channel(kSampleCount), "samples.Y");
}

TEST(Layers, AreFoundUnderTheNamesThatOthersGiveThem) {
  const ExrImage blender =
      file({"ViewLayer.Combined.R", "ViewLayer.Denoising Albedo.R", "ViewLayer.Denoising Normal.X",
            "ViewLayer.Depth.Z", "ViewLayer.Noisy Image.R"});
  EXPECT_EQ(plane_of(blender, {Aov::color, 0}), 4) << "the noisy one of two";
  EXPECT_EQ(plane_of(blender, {Aov::albedo, 0}), 1);
  EXPECT_EQ(plane_of(blender, {Aov::normal, 0}), 2);
  EXPECT_EQ(plane_of(blender, {Aov::depth, 0}), 3);
  EXPECT_EQ(plane_of(blender, {Aov::albedo, 1}), -1);
  const ExrImage pbrt = file({"R", "Albedo.R", "Ns.X", "P.X"});
  EXPECT_EQ(plane_of(pbrt, {Aov::color, 0}), 0);
  EXPECT_EQ(plane_of(pbrt, {Aov::albedo, 0}), 1);
  EXPECT_EQ(plane_of(pbrt, {Aov::normal, 0}), 2);
  EXPECT_EQ(plane_of(pbrt, {Aov::position, 0}), 3);
  EXPECT_EQ(plane_of(file({"albedo.R", "diffuse.albedo.R"}), {Aov::albedo, 0}), 0) << "the exact name first";
  EXPECT_EQ(plane_of(file({"N.R", "N.G", "N.B"}), {Aov::normal, 2}), 2);
  EXPECT_EQ(plane_of(file({"specular.R"}), {Aov::color, 0}), -1) << "another layer's R is no picture";
}

TEST(Gather, TakesWhatIsThereAsItIs) {
  const FilterPlan plan = parse_filter("atrous");
  std::vector<std::string> names, notices;
  for (const Channel& c : plan.inputs()) names.push_back(file_channel(c));
  const Image input = gathered(plan, file(names), &notices);
  for (int p = 0; p < input.planes(); ++p) EXPECT_THAT(input.plane(p), Each(static_cast<float>(p + 1)));
  EXPECT_EQ(input.region(), kRegion);
  EXPECT_THAT(notices, IsEmpty());
}

TEST(Gather, RefusesAMissingGuideByItsName) {
  const ExrImage picture = file({"R", "G", "B", "Z", "N.X", "N.Y", "N.Z"});
  try {
    gathered(parse_filter("atrous"), picture);
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("albedo.RGB (or Denoising Albedo.RGB; Albedo.RGB)"));
    EXPECT_THAT(e.what(), HasSubstr("picture.exr"));
    EXPECT_THAT(e.what(), HasSubstr("--guide albedo=FILE"));
  }
}

TEST(Gather, SaysWhatStandsInForWhatIsMissing) {
  const ExrImage picture = file({"R", "G", "B", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B",
                                 "emission.R", "emission.G", "emission.B"});
  const FilterPlan plan = parse_filter("svgf");
  std::vector<std::string> notices;
  const Image input = gathered(plan, picture, &notices);
  EXPECT_EQ(first_of(plan, input, {Aov::direct, 1}), 2 - 12) << "colour without emission";
  EXPECT_EQ(first_of(plan, input, {Aov::indirect, 1}), 0);
  EXPECT_EQ(first_of(plan, input, {Aov::direct, 1, Statistic::variance_of_mean}), 0)
      << "a constant has no noise";
  EXPECT_THAT(notices,
              ElementsAre(HasSubstr("filtered as one"), HasSubstr("no layer variance: it is estimated")));
}

TEST(Gather, WhatStandsInIsZeroInAllOfItsPixels) {
  const ExrImage picture =
      file({"R", "G", "B", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B"});
  const FilterPlan plan = parse_filter("svgf");
  const std::vector<Channel> inputs = plan.inputs();
  {
    const Floats used(static_cast<std::size_t>(kRegion.area()), std::numeric_limits<float>::quiet_NaN());
    const std::vector<Floats> memory(100, used);  // that is free again, and not clean
  }
  const Image input = gathered(plan, picture);
  for (std::size_t p = 0; p < inputs.size(); ++p) {
    const bool missing = inputs[p].aov == Aov::emission || inputs[p].aov == Aov::indirect;
    if (missing && inputs[p].statistic == Statistic::mean) {
      EXPECT_THAT(input.plane(static_cast<int>(p)), Each(0.0f)) << p;
    }
  }
}

TEST(Gather, ReadsTheSkyOfOthersAsOurs) {
  ExrImage picture = file({"R", "G", "B", "Z", "N.X", "N.Y", "N.Z", "albedo.R", "albedo.G", "albedo.B", "P.X",
                           "P.Y", "P.Z", "emission.R", "emission.G", "emission.B"});
  const float sky[] = {1e10f, std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(),
                       9e9f};
  std::ranges::copy(sky, picture.pixels.plane(3).begin());
  const FilterPlan plan = parse_filter("atrous");
  const Image input = gathered(plan, picture);
  const auto inputs = plan.inputs();
  const auto depth =
      input.plane(static_cast<int>(std::ranges::find(inputs, Channel{Aov::depth, 0}) - inputs.begin()));
  EXPECT_THAT(depth.first(4), ElementsAre(kSkyDepth, kSkyDepth, kSkyDepth, 9e9f));
}

TEST(Gather, PrefersASeparateFileAndRefusesOneOfAnotherSize) {
  const ExrImage picture = file({"R", "G", "B", "Z", "N.X", "N.Y", "N.Z", "P.X", "P.Y", "P.Z", "emission.R",
                                 "emission.G", "emission.B"});
  const FilterPlan plan = parse_filter("atrous");
  Sources sources{&picture, {}, {}};
  sources.separate.emplace("albedo", file({"R", "G", "B"}));
  sources.separate.emplace("N", file({"x", "R", "G", "B"}));
  const Image input = gather(plan, sources, "picture.exr").input;
  EXPECT_EQ(first_of(plan, input, {Aov::albedo, 2}), 3);
  EXPECT_EQ(first_of(plan, input, {Aov::normal, 0}), 2);
  sources.separate.at("albedo").pixels = Image({0, 0, 7, 5}, 3);
  EXPECT_THROW(gather(plan, sources, "picture.exr"), InputError);
}

TEST(Layers, ReadTheVectorsOfCyclesAsMotionToTheRightAndDown) {
  const ExrImage blender =
      file({"ViewLayer.Vector.W", "ViewLayer.Vector.X", "ViewLayer.Vector.Y", "ViewLayer.Vector.Z"});
  EXPECT_EQ(find_plane(blender, {Aov::motion, 0}), (FilePlane{1, -1}));
  EXPECT_EQ(find_plane(blender, {Aov::motion, 1}), (FilePlane{2, 1}));
  EXPECT_EQ(find_plane(blender, {Aov::next_motion, 0}), (FilePlane{3, -1}));
  EXPECT_EQ(find_plane(blender, {Aov::next_motion, 1}), (FilePlane{0, 1}));
  const ExrImage compositor = file({"Vector.A", "Vector.B", "Vector.G", "Vector.R"});
  EXPECT_EQ(find_plane(compositor, {Aov::motion, 1}), (FilePlane{2, 1}));
  EXPECT_EQ(find_plane(compositor, {Aov::next_motion, 1}), (FilePlane{0, 1}));
  EXPECT_EQ(find_plane(file({"Vector.X", "motion.X"}), {Aov::motion, 0}), (FilePlane{1, 1})) << "ours first";
  EXPECT_EQ(plane_of(file({"ViewLayer.IndexOB.X"}), {Aov::object_id, 0}), 0);
  EXPECT_EQ(plane_of(file({"ViewLayer.IndexMA.X"}), {Aov::material_id, 0}), 0);
}

TEST(Layers, KnowTheNamesOfMotionThatOthersWriteInUnitsOfTheirSettings) {
  const ExrImage arnold = file({"motionvector.G", "motionvector.R"}),
                 vray = file({"VRayVelocity.X", "VRayVelocity.Y"});
  EXPECT_FALSE(find_plane(arnold, {Aov::motion, 0})) << "not without --motion-scale";
  EXPECT_EQ(find_motion_of_unknown_unit(arnold, {Aov::motion, 0}), (FilePlane{1}));
  EXPECT_EQ(find_motion_of_unknown_unit(vray, {Aov::motion, 1}), (FilePlane{1}));
  EXPECT_FALSE(find_motion_of_unknown_unit(arnold, {Aov::next_motion, 0}));
  EXPECT_FALSE(find_motion_of_unknown_unit(arnold, {Aov::albedo, 0}));
}

// White noise of variance s^2 gives a mean of s^2; 7x7 means of it, of which about 49 / 4 are independent,
// deviate by sqrt(2 * 4 / 49) of it, and their mean over many by less.
TEST(EstimatedVariance, IsThatOfWhiteNoiseOnAPlane) {
  const Region region{0, 0, 200, 200};
  Image picture(region, 1);
  std::mt19937 random(7);
  std::normal_distribution<float> noise(0, 0.3f);
  for (int y = 0; y < 200; ++y)
    for (int x = 0; x < 200; ++x)
      picture.at(0, x, y) = 5 + 0.02f * static_cast<float>(x) - 0.03f * static_cast<float>(y) + noise(random);
  double sum = 0;
  const Image variance = estimated_variance(picture);
  for (const float v : variance.data()) sum += v;
  EXPECT_NEAR(sum / 40000, 0.09, 0.09 * 5 * std::sqrt(2.0 * 4 / 40000));
}

TEST(EstimatedVariance, KeepsWhatIsNotFiniteToItself) {
  Image picture({0, 0, 9, 9}, 1, 1.0f);
  picture.at(0, 4, 4) = std::numeric_limits<float>::infinity();
  const Image variance = estimated_variance(picture);
  for (const float v : variance.data()) EXPECT_EQ(v, 0);
}

}  // namespace
}  // namespace tessera
