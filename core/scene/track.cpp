// SPDX-License-Identifier: Apache-2.0
#include "core/scene/track.h"

#include <Imath/ImathBox.h>
#include <Imath/ImathMatrixAlgo.h>
#include <Imath/ImathQuat.h>

#include <algorithm>
#include <cmath>

namespace tessera {
namespace {

using MatrixD = Imath::M44d;
using Vec3D = Imath::V3d;

struct Parts {
  Vec3D scale;
  Imath::Quatd rotation;
};

// A mirrored matrix has one negative scale; a row without length leaves the rotation as it is.
Parts parts_of(const MatrixD& m) {
  Vec3D rows[3], scale;
  for (int r = 0; r < 3; ++r) {
    rows[r] = Vec3D(m[r][0], m[r][1], m[r][2]);
    scale[r] = rows[r].length();
    if (!(scale[r] > 0)) return {scale, {}};
    rows[r] /= scale[r];
  }
  if (rows[0].cross(rows[1]).dot(rows[2]) < 0) scale.x = -scale.x, rows[0] = -rows[0];
  const MatrixD turn(rows[0].x, rows[0].y, rows[0].z, 0, rows[1].x, rows[1].y, rows[1].z, 0, rows[2].x,
                     rows[2].y, rows[2].z, 0, 0, 0, 0, 1);
  return {scale, Imath::extractQuat(turn).normalized()};
}

double linear_difference(const MatrixD& a, const MatrixD& b) {
  double most = 0;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c) most = std::max(most, std::abs(a[r][c] - b[r][c]));
  return most;
}

class Sampler {
 public:
  Sampler(const std::function<MatrixD(double)>& pose, const Sampling& sampling)
      : pose_(pose), sampling_(sampling) {}

  Track sample(const std::set<float>& times) {
    measure(times);
    MatrixD last = pose_(*times.begin());
    add(*times.begin(), last);
    for (auto next = std::next(times.begin()); next != times.end(); ++next) {
      const MatrixD pose = pose_(*next);
      fill(track_.times.back(), last, *next, pose, sampling_.halvings);
      add(*next, pose);
      last = pose;
    }
    return std::move(track_);
  }

 private:
  // What the tolerance is a share of: the size of the matrices, and how far the movement reaches.
  void measure(const std::set<float>& times) {
    Imath::Box3d reach;
    float before = *times.begin();
    for (const float t : times) {
      for (const double seconds : {0.5 * (double(before) + t), double(t)}) {
        const MatrixD pose = pose_(seconds);
        reach.extendBy(pose.translation());
        size_ = std::max(size_, linear_difference(pose, MatrixD(0.0)));
      }
      before = t;
    }
    // A float has 24 bits: less than that cannot be told apart.
    const double farthest = std::max(reach.min.length(), reach.max.length());
    reach_ = std::max(reach.size().length(), 1e-3 * farthest);
  }

  void fill(float begin, const MatrixD& first, float end, const MatrixD& last, int halvings) {
    const auto middle = static_cast<float>(0.5 * (double(begin) + end));
    if (halvings == 0 || !(middle > begin && middle < end) || is_close(begin, first, end, last)) return;
    const MatrixD pose = pose_(middle);
    fill(begin, first, middle, pose, halvings - 1);
    add(middle, pose);
    fill(middle, pose, end, last, halvings - 1);
  }

  bool is_close(double begin, const MatrixD& first, double end, const MatrixD& last) const {
    for (const double s : {0.25, 0.5, 0.75}) {
      const MatrixD pose = pose_(begin + s * (end - begin)), guess = between(first, last, s);
      if (linear_difference(pose, guess) > sampling_.tolerance * size_ ||
          (pose.translation() - guess.translation()).length() > sampling_.tolerance * reach_)
        return false;
    }
    return true;
  }

  void add(float seconds, const MatrixD& pose) {
    track_.times.push_back(seconds);
    track_.poses.emplace_back(pose);
  }

  const std::function<MatrixD(double)>& pose_;
  const Sampling& sampling_;
  double size_ = 0, reach_ = 0;
  Track track_;
};

}  // namespace

MatrixD between(const MatrixD& a, const MatrixD& b, double s) {
  const Parts first = parts_of(a), last = parts_of(b);
  MatrixD scale, move;
  scale.setScale(first.scale * (1 - s) + last.scale * s);
  move.setTranslation(a.translation() * (1 - s) + b.translation() * s);
  return scale * Imath::slerpShortestArc(first.rotation, last.rotation, s).toMatrix44() * move;
}

Track sampled_track(const std::set<float>& times, const std::function<MatrixD(double)>& pose,
                    const Sampling& sampling) {
  return Sampler(pose, sampling).sample(times);
}

}  // namespace tessera
