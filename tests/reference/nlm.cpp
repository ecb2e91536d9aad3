// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/nlm.h"

#include <algorithm>
#include <cmath>

#include "tests/reference/features.h"

namespace tessera::reference {
namespace {

std::size_t index(const Region& r, int x, int y) {
  return static_cast<std::size_t>(y - r.y0) * r.width() + (x - r.x0);
}

// For each valid pixel and each valid one q of its window: f(p, q, m), m the mean of of_pair(p', q') over the
// pairs of valid pixels of the patches about the two.
template <typename F, typename OfPair>
void for_each_pair(const NlmWindow& w, OfPair of_pair, F f) {
  const Region& r = w.picture;
  std::vector<double> pairs(static_cast<std::size_t>(r.area()));
  const auto at = [&](int x, int y) { return index(r, x, y); };
  for (int dy = -w.radius; dy <= w.radius; ++dy)
    for (int dx = -w.radius; dx <= w.radius; ++dx) {
      const auto is_pair = [&](int x, int y) { return w.valid(x, y) && w.valid(x + dx, y + dy); };
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x)
          if (is_pair(x, y)) pairs[at(x, y)] = of_pair(at(x, y), at(x + dx, y + dy));
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
          if (!is_pair(x, y)) continue;
          double sum = 0;
          int count = 0;
          for (int j = y - w.patch; j <= y + w.patch; ++j)
            for (int i = x - w.patch; i <= x + w.patch; ++i)
              if (is_pair(i, j)) sum += pairs[at(i, j)], ++count;
          f(at(x, y), at(x + dx, y + dy), sum / count);
        }
    }
}

// Rousselle et al. 2012, section 4.
double weight(const FilterPlan& plan, double distance) {
  const double w = std::exp(-std::max(0.0, distance)), threshold = plan["threshold"];
  return plan.is("cut", "soft") ? std::max(0.0, w - threshold) : w < threshold ? 0.0 : w;
}
double distance(const FilterPlan& plan, const Signal& u, std::size_t p, std::size_t q) {
  const double d = u.value[p] - u.value[q], vp = u.variance[p], vq = u.variance[q], k = plan["k"];
  return (d * d - plan["alpha"] * (vp + std::min(vp, vq))) / (plan["epsilon"] + k * k * (vp + vq));
}

// `filtered` with the weights that `guide` yields, channel by channel.
std::vector<std::vector<double>> by_weights_of(const FilterPlan& plan, const NlmWindow& w,
                                               const std::vector<Signal>& guide,
                                               const std::vector<Signal>& filtered) {
  const std::size_t area = static_cast<std::size_t>(w.picture.area());
  std::vector<std::vector<double>> sums(filtered.size(), std::vector<double>(area));
  std::vector<double> total(area);
  const auto mean_distance = [&](std::size_t p, std::size_t q) {
    double sum = 0;
    for (const Signal& s : guide) sum += distance(plan, s, p, q);
    return sum / static_cast<double>(guide.size());
  };
  for_each_pair(w, mean_distance, [&](std::size_t p, std::size_t q, double d) {
    const double weight_of_q = p == q ? 1 : weight(plan, d);  // no patch is nearer to a patch than itself
    total[p] += weight_of_q;
    for (std::size_t c = 0; c < filtered.size(); ++c) sums[c][p] += weight_of_q * filtered[c].value[q];
  });
  for (auto& s : sums)
    for (std::size_t i = 0; i < area; ++i) s[i] = total[i] > 0 ? s[i] / total[i] : 0;
  return sums;
}

// Three channels of the colour; with the variance of the mean of a population where samples are counted.
std::vector<Signal> colour_of(const Features& f, Share share) {
  const Region& r = f.region();
  std::vector<Signal> all(3);
  for (int c = 0; c < 3; ++c)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double n = share == Share::all ? f.samples(x, y) : 0;
        const double v = f.at(Aov::color, c, x, y, Statistic::variance_of_mean, share);
        all[c].value.push_back(f.at(Aov::color, c, x, y, Statistic::mean, share));
        all[c].variance.push_back(share == Share::all ? (n > 1 ? v * (n - 1) / n : 0) : v);
      }
  return all;
}

}  // namespace

std::vector<double> nlm_mean_of_exp(const NlmWindow& w, const Signal& s, double epsilon) {
  const std::size_t area = static_cast<std::size_t>(w.picture.area());
  std::vector<double> sum(area), total(area);
  const auto weight_of_pair = [&](std::size_t p, std::size_t q) {
    const double d = s.value[p] - s.value[q];
    return std::exp(-d * d / (epsilon + s.variance[p] + s.variance[q]));
  };
  for_each_pair(w, weight_of_pair, [&](std::size_t p, std::size_t q, double weight_of_q) {
    total[p] += weight_of_q;
    sum[p] += weight_of_q * s.value[q];
  });
  for (std::size_t i = 0; i < area; ++i) sum[i] = total[i] > 0 ? sum[i] / total[i] : 0;
  return sum;
}

Image nlm(const FilterPlan& plan, const Image& input) {
  const Features f(plan, input);
  const Region& r = input.region();
  const bool dual = plan.is("mode", "dual");
  const auto own = [&](std::string_view name, int standard) {
    return plan[name] > 0 ? static_cast<int>(plan[name]) : standard;
  };
  const NlmWindow w{r, own("radius", dual ? 10 : 5), own("patch", dual ? 3 : 2),
                    [&](int x, int y) { return f.valid(x, y); }};
  std::vector<std::vector<double>> result(3);
  if (dual) {
    const std::vector<Signal> a = colour_of(f, Share::a), b = colour_of(f, Share::b);
    const auto a_by_b = by_weights_of(plan, w, b, a), b_by_a = by_weights_of(plan, w, a, b);
    for (int c = 0; c < 3; ++c)
      for (std::size_t i = 0; i < a_by_b[c].size(); ++i)
        result[c].push_back((a_by_b[c][i] + b_by_a[c][i]) / 2);
  } else {
    const std::vector<Signal> all = colour_of(f, Share::all);
    for (int c = 0; c < 3; ++c)
      result[c] = plan.is("patch_mode", "mean_of_exp") ? nlm_mean_of_exp(w, all[c], plan["epsilon"])
                                                       : by_weights_of(plan, w, {all[c]}, {all[c]})[0];
  }
  Image out(r, 3);
  for (int c = 0; c < 3; ++c)
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) {
        const double color = dual ? (f.at(Aov::color, c, x, y, Statistic::mean, Share::a) +
                                     f.at(Aov::color, c, x, y, Statistic::mean, Share::b)) /
                                        2
                                  : f.at(Aov::color, c, x, y);
        out.at(c, x, y) = static_cast<float>(f.valid(x, y)          ? result[c][f.index(x, y)]
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
  return out;
}

}  // namespace tessera::reference
