// SPDX-License-Identifier: Apache-2.0
// Choosing one of many in proportion to weights, by inversion of the cumulative sum, which keeps strata.
#pragma once

#include <algorithm>
#include <span>
#include <vector>

namespace tessera::tracer {

class Distribution {
 public:
  Distribution() = default;
  // Weights are finite and not negative. If all are zero every index is equally likely.
  explicit Distribution(std::span<const float> weights) : sums_(weights.size() + 1, 0.0f) {
    double total = 0;
    for (const float w : weights) total += w;
    double sum = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) {
      sum += total > 0 ? weights[i] / total : 1.0 / static_cast<double>(weights.size());
      sums_[i + 1] = static_cast<float>(std::min(sum, 1.0));
    }
    if (!weights.empty()) sums_.back() = 1.0f;
  }

  struct Pick {
    std::size_t index;
    float share;  // where in the chosen index's interval u fell, in [0, 1): a fresh random number
  };
  // Precondition: size() > 0. u in [0, 1).
  Pick pick(float u) const {
    const auto after = std::upper_bound(sums_.begin(), sums_.end(), u);
    const auto i = static_cast<std::size_t>(after - sums_.begin()) - 1;
    return {i, std::min((u - sums_[i]) / probability(i), 0x1.fffffep-1f)};
  }
  // Exactly the measure of the u that pick() sends to i.
  float probability(std::size_t i) const { return sums_[i + 1] - sums_[i]; }
  std::size_t size() const { return sums_.empty() ? 0 : sums_.size() - 1; }

 private:
  std::vector<float> sums_;
};

}  // namespace tessera::tracer
