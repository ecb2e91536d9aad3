// SPDX-License-Identifier: Apache-2.0
#include "core/quality/temporal.h"

#include <cassert>
#include <cmath>
#include <limits>
#include <utility>

namespace tessera {
namespace {

constexpr double kLuma[3] = {0.2126, 0.7152, 0.0722};

// Mean over the pixels of sum_c kLuma[c] f(c, pixel).
template <typename F>
double mean_luma(const Image& like, const F& f) {
  double sum = 0;
  const std::size_t n = like.plane(0).size();
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < n; ++i) sum += kLuma[c] * f(c, i);
  return sum / static_cast<double>(n);
}

}  // namespace

void FrameSpread::add(const Image& frame) {
  assert(frame.planes() == 3 && (frames_ == 0 || frame.region() == mean_.region()));
  if (frames_ == 0) mean_ = square_ = Image(frame.region(), 3);
  const float share = 1.0f / static_cast<float>(++frames_);
  for (std::size_t i = 0; i < frame.data().size(); ++i) {
    const float away = frame.data()[i] - mean_.data()[i];
    mean_.data()[i] += away * share;
    square_.data()[i] += away * (frame.data()[i] - mean_.data()[i]);
  }
}

double FrameSpread::deviation() const {
  if (frames_ < 2) return std::numeric_limits<double>::quiet_NaN();
  return mean_luma(square_,
                   [&](int c, std::size_t i) { return std::sqrt(square_.plane(c)[i] / (frames_ - 1.0)); });
}

std::optional<TemporalStep> TemporalError::add(Image x, Image r) {
  assert(x.region() == r.region() && x.planes() == 3 && r.planes() == 3);
  x_spread_.add(x);
  r_spread_.add(r);
  const Image x0 = std::exchange(x_, std::move(x)), r0 = std::exchange(r_, std::move(r));
  if (x0.empty()) return std::nullopt;
  const auto step = [](const Image& now, const Image& before, int c, std::size_t i) {
    return double{now.plane(c)[i]} - before.plane(c)[i];
  };
  TemporalStep t;
  t.error = mean_luma(x_, [&](int c, std::size_t i) { return std::abs(step(x_, x0, c, i)); });
  t.reference_error = mean_luma(x_, [&](int c, std::size_t i) { return std::abs(step(r_, r0, c, i)); });
  t.residual =
      mean_luma(x_, [&](int c, std::size_t i) { return std::abs(step(x_, x0, c, i) - step(r_, r0, c, i)); });
  error_ += t.error;
  reference_error_ += t.reference_error;
  return t;
}

double TemporalError::relative_error() const {
  return std::abs(error_ - reference_error_) / reference_error_;  // the number of frames cancels
}

}  // namespace tessera
