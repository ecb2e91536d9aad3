// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/taa.h"

#include <algorithm>
#include <cmath>
#include <optional>

namespace tessera::reference {
namespace {

Rgb luma_chroma(const Rgb& c) {
  return {(c[0] + 2 * c[1] + c[2]) / 4, (c[0] - c[2]) / 2, (2 * c[1] - c[0] - c[2]) / 4};
}
Rgb from_luma_chroma(const Rgb& c) { return {c[0] + c[1] - c[2], c[0] + c[2], c[0] - c[1] - c[2]}; }

class Taa {
 public:
  Taa(const FilterPlan& plan, const Image& input, const Image& history, const Image& picture)
      : plan_(plan), f_(plan, input), history_(history), picture_(picture) {}

  Rgb at(int x, int y) const {
    const Rgb now = color(x, y);
    const std::optional<Rgb> before = seen_before(x, y);
    Rgb mean, deviation;
    statistics(x, y, mean, deviation);
    if (!before || !(squared(deviation) + squared(difference(mean, luma_chroma(now))) < 1e35)) return now;
    const Rgb then = clipped(*before, mean, deviation);
    const double alpha = plan_["taa_alpha"], a = alpha / (1 + std::max(0.0, luminance(now))),
                 b = (1 - alpha) / (1 + std::max(0.0, luminance(then)));
    Rgb mixed;
    for (int c = 0; c < 3; ++c) mixed[c] = (a * now[c] + b * then[c]) / (a + b);
    return mixed;
  }

 private:
  Rgb color(int x, int y) const { return {picture_.at(0, x, y), picture_.at(1, x, y), picture_.at(2, x, y)}; }

  template <typename Body>
  void each_around(int x, int y, const Body& body) const {
    for (int j = y - 1; j <= y + 1; ++j)
      for (int i = x - 1; i <= x + 1; ++i)
        if (f_.inside(i, j)) body(i, j);
  }

  // By the longest motion around.
  std::optional<Rgb> seen_before(int x, int y) const {
    // In single precision, for rounding decides which of equally long ones is the longest.
    float longest = -1, mx = kSkyDepth, my = kSkyDepth;
    each_around(x, y, [&](int i, int j) {
      const float u = static_cast<float>(f_.at(Aov::motion, 0, i, j));
      const float v = static_cast<float>(f_.at(Aov::motion, 1, i, j)), length = std::fma(u, u, v * v);
      if (length > longest && length < 1e12f) longest = length, mx = u, my = v;
    });
    const float qx = static_cast<float>(x) - mx, qy = static_cast<float>(y) - my;
    const Region& r = history_.region();
    if (!(qx > r.x0 - 3 && qx < r.x1 + 3 && qy > r.y0 - 3 && qy < r.y1 + 3)) return std::nullopt;
    double sum = 0;
    Rgb total{};
    const int left = static_cast<int>(std::floor(qx)), top = static_cast<int>(std::floor(qy));
    for (int j = top; j < top + 2; ++j)
      for (int i = left; i < left + 2; ++i) {
        if (!r.contains(i, j)) continue;
        bool fit = true;
        for (int c = 0; c < 3; ++c) fit &= std::abs(old(c, i, j)) <= 1e32f;
        const double w = fit ? (1 - std::abs(qx - i)) * (1 - std::abs(qy - j)) : 0;
        sum += w;
        for (int c = 0; c < 3; ++c) total[c] += fit ? w * old(c, i, j) : 0;
      }
    if (sum < 0.25) return std::nullopt;
    return Rgb{total[0] / sum, total[1] / sum, total[2] / sum};
  }
  float old(int c, int x, int y) const { return history_.at(history_.planes() - 3 + c, x, y); }

  void statistics(int x, int y, Rgb& mean, Rgb& deviation) const {
    double count = 0;
    mean = deviation = {};
    each_around(x, y, [&](int i, int j) {
      const Rgb c = luma_chroma(color(i, j));
      ++count;
      for (int k = 0; k < 3; ++k) mean[k] += c[k];
    });
    for (double& v : mean) v /= count;
    each_around(x, y, [&](int i, int j) {
      const Rgb d = difference(luma_chroma(color(i, j)), mean);
      for (int k = 0; k < 3; ++k) deviation[k] += d[k] * d[k];
    });
    for (double& v : deviation) v = std::sqrt(v / count);
  }

  Rgb clipped(const Rgb& rgb, const Rgb& mean, const Rgb& deviation) const {
    Rgb d = difference(luma_chroma(rgb), mean);
    double farthest = 0;
    for (int c = 0; c < 3; ++c)
      farthest = std::max(farthest, std::abs(d[c]) / (plan_["taa_gamma"] * deviation[c] + 1e-30));
    if (farthest <= 1) return rgb;
    for (int c = 0; c < 3; ++c) d[c] = mean[c] + d[c] / farthest;
    return from_luma_chroma(d);
  }

  const FilterPlan& plan_;
  Features f_;
  const Image &history_, &picture_;
};

}  // namespace

void taa(const FilterPlan& plan, const Image& input, const Image& history, Image& result) {
  const Image picture = result;
  const Taa taa(plan, input, history, picture);
  const Region& r = input.region();
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const Rgb mixed =
          history.empty() ? Rgb{picture.at(0, x, y), picture.at(1, x, y), picture.at(2, x, y)} : taa.at(x, y);
      for (int c = 0; c < 3; ++c)
        result.at(c, x, y) = result.at(result.planes() - 3 + c, x, y) = static_cast<float>(mixed[c]);
    }
}

}  // namespace tessera::reference
