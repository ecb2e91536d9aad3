// SPDX-License-Identifier: Apache-2.0
#include "core/scene/cuts.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/scene/framing.h"
#include "core/scene/track.h"

namespace tessera {
namespace {

constexpr double kTimes = 5, kShareOfScene = 0.02;
constexpr double kTurn = 10 * std::numbers::pi / 180;

struct Step {
  double distance = 0, angle = 0;
};

double angle_between(const Matrix& a, const Matrix& b, int axis) {
  const auto of = [&](const Matrix& m) {
    return Imath::V3d(m[axis][0], m[axis][1], m[axis][2]).normalized();
  };
  return std::acos(std::clamp(of(a).dot(of(b)), -1.0, 1.0));
}

Step step(const Matrix& a, const Matrix& b) {
  const Imath::V3d from(a[3][0], a[3][1], a[3][2]), to(b[3][0], b[3][1], b[3][2]);
  return {(to - from).length(), std::max(angle_between(a, b, 1), angle_between(a, b, 2))};
}

bool jumps(double here, double before, double after, double least) {
  return here > least && here >= kTimes * std::max(before, after);
}

}  // namespace

std::vector<int> cuts_of(const Scene& scene, const Camera& camera, const std::vector<int>& frames) {
  if (camera.track < 0) return {};
  const Movement movement(scene.tracks[static_cast<std::size_t>(camera.track)]);
  const auto stands = [&](int frame) {
    return camera.to_world * movement.at(double(frame) / double(scene.frames_per_second));
  };
  const Imath::Box3f bounds = bounds_of(scene);
  const double least = bounds.isEmpty() ? 0 : kShareOfScene * double(bounds.size().length());
  std::vector<int> cuts;
  for (const int f : frames) {
    const Matrix last = stands(f - 1), now = stands(f);
    const Step here = step(last, now), before = step(stands(f - 2), last), after = step(now, stands(f + 1));
    if (jumps(here.distance, before.distance, after.distance, least) ||
        jumps(here.angle, before.angle, after.angle, kTurn))
      cuts.push_back(f);
  }
  return cuts;
}

}  // namespace tessera
