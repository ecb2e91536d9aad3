// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "worker/denoise/filters/nlm.h"
#include "worker/denoise/window.h"

namespace tessera {

std::string nlm_options(const NlmShape& s, bool soft) {
  return fmt::format(
      "-DNLM_RADIUS={} -DNLM_PATCH={} -DNLM_CHANNELS={} -DNLM_HALVES={} -DNLM_GROUP={} -DNLM_SOFT={}",
      s.radius, s.patch, s.channels, s.halves, kNlmGroup, soft ? 1 : 0);
}

cl_float2 nlm_variance(const NlmTuning& t) {
  return {{static_cast<float>(t.alpha), static_cast<float>(1.5 * t.epsilon * t.alpha / (t.k * t.k))}};
}

Nlm::Nlm(Stage& s, const Region& over, const NlmShape& shape)
    : stage_(s), over_(over), shape_(shape), tiles_(tiles(s, over, kNlmColumns, kNlmRows)) {
  const int vector = s.vector(), columns = tiles_.columns, rows = tiles_.rows;
  const int width = rounded_up(columns + 2 * shape.patch + shape.radius + kNlmGroup, vector);
  const int height = rows + shape.radius;
  const int pitch = rounded_up(columns + 2 * shape.reach() + kNlmGroup + vector, vector);
  room_ = nlm_planes(shape) * pitch * (rows + 2 * shape.reach()) +
          shape.halves * (shape.channels + 1) * columns * rows +
          kNlmGroup * ((2 * shape.halves + 1) * height + kNlmRowsBeside) * width;
  scratch_ = s.scratch(static_cast<std::size_t>(tiles_.groups) * room_);
}

void Nlm::run(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to,
              const NlmTuning& t) {
  constexpr double kOne = 127 * kOctave;  // the exponent of a weight of 1
  const double a = t.alpha / (t.k * t.k), mean = a * std::numbers::log2e * kOctave / shape_.channels;
  const int taps = 2 * shape_.patch + 1;
  const cl_float4 k{{static_cast<float>(mean / (taps * taps)), static_cast<float>(mean),
                     static_cast<float>(std::max(0.0, kOne + kOctave * std::log2(t.threshold))),
                     static_cast<float>(t.epsilon * a)}};
  stage_.run("nlm", {0, 0, 1, tiles_.groups}, 1, valid, signals, first, to, first_to, stage_.layout(), over_,
             tiles_.columns, tiles_.rows, scratch_, room_, k, static_cast<float>(t.threshold));
}

void Nlm::mean_of_exp(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to) {
  stage_.run("nlm_mean_of_exp", {0, 0, 1, tiles_.groups}, 1, valid, signals, first, to, first_to,
             stage_.layout(), over_, tiles_.columns, tiles_.rows, scratch_, room_);
}

}  // namespace tessera
