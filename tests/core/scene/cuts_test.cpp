// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cuts.h"

#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

// A scene of a diameter of 10 whose camera stands at x(frame), turned by y(frame) degrees; one frame a
// second.
struct Shot {
  Scene scene;
  Camera camera;

  template <class Place>
  Shot(Place place, int frames) {
    Sphere ball;
    ball.radius = 5 / std::numbers::sqrt3_v<float>;
    scene.spheres.push_back(ball);
    scene.frames_per_second = 1;
    Track track;
    for (int f = -2; f <= frames + 2; ++f) {
      const auto [x, turn] = place(f);
      Matrix pose;
      pose.rotate(Imath::V3f(0, turn * std::numbers::pi_v<float> / 180, 0));
      Matrix shift;
      shift.translate(Imath::V3f(x, 0, 0));
      track.times.push_back(static_cast<float>(f));
      track.poses.push_back(pose * shift);
    }
    scene.tracks.push_back(track);
    camera.track = 0;
  }
};

template <class Place>
std::vector<int> cuts(Place place) {
  const Shot shot(place, 8);
  return cuts_of(shot.scene, shot.camera, {1, 2, 3, 4, 5, 6, 7, 8});
}

using At = std::pair<float, float>;

TEST(Cuts, AreWhereTheCameraJumps) {
  EXPECT_THAT(cuts([](int f) { return At(f < 5 ? 0.0f : 3.0f, 0); }), ElementsAre(5)) << "from rest to rest";
  EXPECT_THAT(cuts([](int f) { return At(0.1f * f + (f < 5 ? 0.0f : 3.0f), 0); }), ElementsAre(5));
  EXPECT_THAT(cuts([](int f) { return At(0, f < 3 ? 0.0f : 40.0f); }), ElementsAre(3)) << "on its feet";
  EXPECT_THAT(cuts([](int f) { return At(f < 3 ? 0.0f : f < 6 ? 4.0f : 1.0f, 0); }), ElementsAre(3, 6));
}

TEST(Cuts, AreNotWhereItMovesFastStartsOrStops) {
  EXPECT_THAT(cuts([](int f) { return At(3.0f * f, 50.0f * f); }), IsEmpty());
  EXPECT_THAT(cuts([](int f) { return At(f < 4 ? 0.0f : 2.0f * (f - 4), 0); }), IsEmpty()) << "starts";
  EXPECT_THAT(cuts([](int f) { return At(2.0f * std::min(f, 4), 0); }), IsEmpty()) << "stops";
  EXPECT_THAT(cuts([](int f) { return At(f < 4 ? 0.0f : 0.1f, f < 4 ? 0.0f : 5.0f); }), IsEmpty())
      << "a nudge";
  EXPECT_THAT(cuts([](int f) { return At(std::exp(0.8f * f), 0); }), IsEmpty()) << "faster and faster";
}

TEST(Cuts, AFrameIsOneWhateverOthersAreAskedFor) {
  const Shot shot([](int f) { return At(f < 5 ? 0.0f : 3.0f, 0); }, 8);
  EXPECT_THAT(cuts_of(shot.scene, shot.camera, {5}), ElementsAre(5));
  EXPECT_THAT(cuts_of(shot.scene, shot.camera, {4, 6}), IsEmpty());
  EXPECT_THAT(cuts_of(shot.scene, Camera{}, {5}), IsEmpty()) << "a camera that rests";
}

}  // namespace
}  // namespace tessera
