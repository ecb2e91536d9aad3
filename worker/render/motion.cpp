// SPDX-License-Identifier: Apache-2.0
#include "worker/render/motion.h"

#include <algorithm>
#include <cmath>

namespace tessera::tracer {
namespace {

// How far linear interpolation may be from the true pose.
constexpr float kMotionSlack = 1e-3f;
constexpr std::size_t kMostSteps = 128;  // Embree takes one more

// The largest difference of the linear part, and of the translation.
struct Apart {
  float linear = 0, way = 0;
  void add(const Matrix& a, const Matrix& b) {
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) {
        float& most = i < 3 ? linear : way;
        most = std::max(most, std::abs(a[i][k] - b[i][k]));
      }
  }
};

}  // namespace

std::vector<Matrix> motion_steps(const Movement& movement, Shutter shutter) {
  if (!(shutter.close > shutter.open)) return {movement.at(shutter.open)};
  std::vector<Matrix> fine;
  Apart size, travelled;
  for (std::size_t i = 0; i <= kMostSteps; ++i) {
    const double share = static_cast<double>(i) / kMostSteps;
    fine.push_back(movement.at(shutter.open + (shutter.close - shutter.open) * share));
    size.add(fine.back(), Matrix(0.0f));
    travelled.add(fine.back(), fine.front());
  }
  if (travelled.linear == 0 && travelled.way == 0) return {fine[0]};
  for (std::size_t stride = kMostSteps;; stride /= 2) {
    Apart error;
    std::vector<Matrix> coarse;
    for (std::size_t i = 0; i <= kMostSteps; ++i) {
      if (i % stride == 0) coarse.push_back(fine[i]);
      const std::size_t from = std::min(i / stride, kMostSteps / stride - 1) * stride;
      const float share = static_cast<float>(i - from) / static_cast<float>(stride);
      error.add(fine[from] * (1.0f - share) + fine[from + stride] * share, fine[i]);
    }
    if (stride == 1 || (error.linear <= kMotionSlack * size.linear &&
                        error.way <= kMotionSlack * travelled.way + 1e-6f * size.way))
      return coarse;
  }
}

}  // namespace tessera::tracer
