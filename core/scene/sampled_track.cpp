// SPDX-License-Identifier: Apache-2.0
#include "core/scene/sampled_track.h"

#include <Imath/ImathBox.h>

#include <algorithm>
#include <cmath>

#include "core/scene/track.h"

namespace tessera {
namespace {

using MatrixD = Imath::M44d;

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
    const Track guessed{{0, 1}, {Matrix(first), Matrix(last)}};
    for (const double s : {0.25, 0.5, 0.75}) {
      const MatrixD pose = pose_(begin + s * (end - begin)), guess(tessera::pose(guessed, s));
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

Track sampled_track(const std::set<float>& times, const std::function<MatrixD(double)>& pose,
                    const Sampling& sampling) {
  return Sampler(pose, sampling).sample(times);
}

}  // namespace tessera
