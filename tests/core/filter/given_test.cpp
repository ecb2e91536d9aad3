// SPDX-License-Identifier: Apache-2.0
#include "core/filter/given.h"

#include <gmock/gmock.h>

#include <filesystem>
#include <fstream>
#include <set>

#include "core/error.h"
#include "core/layers.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr Region kRegion{-3, 5, 9, 12}, kDisplay{0, 0, 8, 20};

Image numbered(const FilterPlan& plan) {
  Image input(kRegion, static_cast<int>(plan.inputs().size()));
  for (std::size_t i = 0; i < input.data().size(); ++i)
    input.data()[i] = 1.0f / (1.0f + static_cast<float>(i));
  return input;
}

// Through the bytes of a file, which is where they come from.
ExrImage through_bytes(const ExrImage& file) {
  const fs::path path = fs::path(testing::TempDir()) / "given.exr";
  std::ofstream(path, std::ios::binary) << exr_bytes(file, "none");
  ExrImage back = read_exr(path);
  fs::remove(path);
  return back;
}

std::vector<FilterPlan> plans() {
  std::vector<FilterPlan> all;
  for (const FilterDescription& d : filters()) {
    all.push_back(parse_filter(d.name));
    if (d.history) all.push_back(parse_filter(std::string(d.name) + ":history=on"));
  }
  return all;
}

TEST(Given, EveryPlaneOfEveryFilterHasANameOfItsOwn) {
  for (const FilterPlan& plan : plans()) {
    std::set<std::string> names;
    for (const Channel& c : plan.inputs()) EXPECT_TRUE(names.insert(file_channel(c)).second) << plan.name;
  }
}

TEST(Given, ThePlanesOfEveryFilterComeBackInOrderToTheLastBit) {
  for (const FilterPlan& plan : plans()) {
    const ExrImage file = through_bytes(given_file(plan, numbered(plan), kDisplay));
    EXPECT_EQ(file.display, kDisplay);
    EXPECT_TRUE(same_bits(given_planes(plan, file, kRegion, "it"), numbered(plan))) << to_string(plan);
  }
}

TEST(Given, EqualPlanesAreEqualBytes) {
  const FilterPlan plan = parse_filter("nlm");
  EXPECT_EQ(exr_bytes(given_file(plan, numbered(plan), kDisplay), "none"),
            exr_bytes(given_file(plan, numbered(plan), kDisplay), "none"));
}

TEST(Given, OtherPixelsAndOtherChannelsAreRefusedWithWhatIsAccepted) {
  const FilterPlan nlm = parse_filter("nlm"), none = parse_filter("none");
  const ExrImage good = given_file(nlm, numbered(nlm), kDisplay);
  const auto reading = [](const FilterPlan& plan, const ExrImage& file, const Region& region = kRegion) {
    return [=] { given_planes(plan, file, region, "the blob"); };
  };
  EXPECT_NO_THROW(reading(nlm, good)());
  EXPECT_THAT(reading(nlm, good, {0, 0, 9, 12}), ThrowsMessage<InputError>(HasSubstr("0 0 to 9 12")));
  ExrImage renamed = good;
  renamed.channels[0].name = "other";
  EXPECT_THAT(reading(nlm, renamed), ThrowsMessage<InputError>(HasSubstr("the blob: has no channel")));
  ExrImage more = given_file(none, numbered(none), kDisplay);
  EXPECT_NO_THROW(reading(none, more)());
  more.channels.push_back({"extra", ExrType::float32});
  more.pixels = Image(kRegion, more.pixels.planes() + 1);
  EXPECT_THAT(reading(none, more), ThrowsMessage<InputError>(HasSubstr("channels; accepted: the 3")));
}

}  // namespace
}  // namespace tessera
