// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/denoise/filters/nlm.h"
#include "worker/denoise/window.h"

namespace tessera {
namespace {

constexpr int kGroups = 16;  // work-groups: some for each core, so that none waits long for the last

int parts(int length, int most) { return (length + most - 1) / most; }
int rounded_up(int v, int step) { return parts(v, step) * step; }
// Tiles of nearly one size.
int even(int length, int most) { return parts(length, parts(length, most)); }

}  // namespace

std::string nlm_options(const NlmShape& s, bool soft) {
  return fmt::format(
      "-DNLM_RADIUS={} -DNLM_PATCH={} -DNLM_CHANNELS={} -DNLM_HALVES={} -DNLM_GROUP={} -DNLM_SOFT={}",
      s.radius, s.patch, s.channels, s.halves, kNlmGroup, soft ? 1 : 0);
}

cl_float2 nlm_variance(const NlmTuning& t) {
  return {{static_cast<float>(t.alpha), static_cast<float>(1.5 * t.epsilon * t.alpha / (t.k * t.k))}};
}

Nlm::Nlm(Stage& s, const Region& over, const NlmShape& shape) : stage_(s), over_(over), shape_(shape) {
  const int vector = s.vector();
  // The kernel starts at a multiple of the vector.
  const int wide = over.width() + (over.x0 - s.outer().x0) % vector;
  columns_ = rounded_up(even(wide, kNlmColumns), vector);
  rows_ = even(over.height(), kNlmRows);
  groups_ = std::min(kGroups, parts(wide, columns_) * parts(over.height(), rows_));
  const int width = rounded_up(columns_ + 2 * shape.patch + shape.radius + kNlmGroup, vector);
  const int height = rows_ + shape.radius;
  const int pitch = rounded_up(columns_ + 2 * shape.reach() + kNlmGroup + vector, vector);
  room_ = (2 * shape.halves * shape.channels + 1) * pitch * (rows_ + 2 * shape.reach()) +
          shape.halves * (shape.channels + 1) * columns_ * rows_ +
          kNlmGroup * (2 * shape.halves + 1) * width * height;
  scratch_ = s.scratch(static_cast<std::size_t>(groups_) * room_);
}

void Nlm::run(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to,
              const NlmTuning& t) {
  constexpr double kOne = 127 * kOctave;  // the exponent of a weight of 1
  const double a = t.alpha / (t.k * t.k), mean = a * std::numbers::log2e * kOctave / shape_.channels;
  const int taps = 2 * shape_.patch + 1;
  const cl_float4 k{{static_cast<float>(mean / (taps * taps)), static_cast<float>(mean),
                     static_cast<float>(std::max(0.0, kOne + kOctave * std::log2(t.threshold))),
                     static_cast<float>(t.epsilon * a)}};
  stage_.run("nlm", {0, 0, 1, groups_}, 1, valid, signals, first, to, first_to, stage_.layout(), over_,
             columns_, rows_, scratch_, room_, k, static_cast<float>(t.threshold));
}

void Nlm::mean_of_exp(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to) {
  stage_.run("nlm_mean_of_exp", {0, 0, 1, groups_}, 1, valid, signals, first, to, first_to, stage_.layout(),
             over_, columns_, rows_, scratch_, room_);
}

}  // namespace tessera
