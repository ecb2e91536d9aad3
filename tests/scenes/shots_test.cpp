// SPDX-License-Identifier: Apache-2.0
#include "scenes/shots.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cmath>
#include <fstream>
#include <iterator>
#include <map>

#include "core/film.h"
#include "core/scene/load.h"
#include "worker/render/render.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

class MovingScenes : public testing::Test {
 protected:
  static void SetUpTestSuite() { scenes::write_shots(folder()); }
  static void TearDownTestSuite() { fs::remove_all(folder()); }
  static fs::path folder() {
    return fs::path(testing::TempDir()) / ("tessera-shots-" + std::to_string(getpid()));
  }
  static fs::path file(std::string_view name) { return folder() / (std::string(name) + ".json"); }
};

std::map<std::string, std::string> contents(const fs::path& folder) {
  std::map<std::string, std::string> all;
  for (const fs::directory_entry& entry : fs::directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    all[entry.path().filename()] = {std::istreambuf_iterator<char>(in), {}};
  }
  return all;
}

TEST_F(MovingScenes, AreTheSameBytesEveryTime) {
  const fs::path again = folder().string() + "_again";
  scenes::write_shots(again);
  EXPECT_EQ(contents(folder()), contents(again));
  fs::remove_all(again);
}

TEST_F(MovingScenes, LoadWithoutWarnings) {
  for (const std::string_view name : scenes::kShots)
    EXPECT_THAT(load_scene(file(name)).warnings, testing::IsEmpty());
}

// The motion of each pixel of a small frame in the middle of the shot, in pixels.
std::vector<double> motions(const fs::path& scene_file) {
  constexpr Region kFrame{0, 0, 64, 36};
  constexpr int kNumber = scenes::kShotFrames / 2;
  const auto scene = std::make_shared<const Scene>(load_scene(scene_file));
  RenderSettings settings{.size = {64, 36}, .aovs = AovSet{Aov::motion}};
  Film film(kFrame, settings.aovs);
  film.fold(render(*prepare(scene, settings, kNumber), settings, kNumber, kFrame, {0, 1}));
  const Image motion = developed(film.sums(), film.layout(), channels_of(Aov::motion), Part::all);
  std::vector<double> lengths;
  for (std::size_t i = 0; i < motion.plane(0).size(); ++i)
    lengths.push_back(std::hypot(motion.plane(0)[i], motion.plane(1)[i]));
  return lengths;
}

TEST_F(MovingScenes, MoveWhatTheySayTheyDo) {
  using testing::Each, testing::AllOf, testing::Gt, testing::Lt, testing::Contains;
  EXPECT_THAT(motions(file("flight")), Each(AllOf(Gt(0.0), Lt(6.0))));
  EXPECT_THAT(motions(file("glossy_flight")), Each(AllOf(Gt(0.0), Lt(6.0))));
  EXPECT_THAT(motions(file("still")), Each(Lt(1e-3)));
  EXPECT_THAT(motions(file("light")), Each(Lt(1e-3)));
  EXPECT_THAT(motions(file("object")),
              AllOf(Contains(Gt(0.2)).Times(Gt(20)), Contains(Lt(1e-3)).Times(Gt(1000))));
}

}  // namespace
}  // namespace tessera
