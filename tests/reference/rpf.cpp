// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/rpf.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <numbers>

#include "core/filter/rpf.h"
#include "tests/reference/features.h"

namespace tessera::reference {
namespace {

constexpr int kFeatures = 16, kRandom = 6, kScreen = 2;
constexpr int kNumbers = kFeatures + kRandom + kScreen + 3;  // the last three are the colour

// Features, random parameters, screen, colour. What decides - which samples are neighbours, in which buckets
// they are - is computed in single precision as in the kernels: a last bit more, and a sample is elsewhere.
struct Sample {
  std::array<float, kNumbers> v;
  Rgb color;  // after the last iteration
};
using Pixel = std::vector<Sample>;

struct Moments {
  std::array<float, kNumbers> mean, inverse_deviation;  // 0 where they do not differ
};

Moments moments(const std::vector<const Sample*>& samples, const std::array<float, kNumbers>& about) {
  Moments m{};
  const float n = static_cast<float>(samples.size());
  for (int k = 0; k < kNumbers; ++k) {
    float sum = 0, square = 0, low = INFINITY, high = -INFINITY;
    for (const Sample* s : samples) {
      const float d = s->v[k] - about[k];
      sum += d;
      square = std::fma(d, d, square);
      low = std::min(low, d);
      high = std::max(high, d);
    }
    const float mean = sum / n, variance = std::fma(-mean, mean, square / n);
    m.mean[k] = about[k] + mean;
    m.inverse_deviation[k] = low < high && variance > 0 ? 1 / std::sqrt(variance) : 0;
  }
  return m;
}

std::uint32_t mixed(std::uint32_t x) {
  x = (x ^ x >> 16) * 0x85ebca6bu;
  x = (x ^ x >> 13) * 0xc2b2ae35u;
  return x ^ x >> 16;
}

double deviation_of(const std::vector<double>& v) {
  double sum = 0, square = 0;
  for (const double x : v) sum += x / v.size();
  for (const double x : v) square += (x - sum) * (x - sum) / v.size();
  return std::sqrt(square);
}

class Rpf {
 public:
  Rpf(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), constants_(rpf_constants(plan.parameters)) {
    const Region& r = f_.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) pixels_.push_back(read(x, y));
  }

  void iterate(int t) {
    const RpfIteration i = rpf_iteration(plan_.parameters, t);
    std::vector<Pixel> next = pixels_;
    const Region& r = f_.region();
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x)
        if (!at(x, y).empty()) filter(next[f_.index(x, y)], neighbours(x, y, t, i), i);
    pixels_ = std::move(next);
  }

  Image result() const {
    const Region& r = f_.region();
    Image out(r, 3);
    for (int k = 0; k < 3; ++k)
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
          const Pixel& p = at(x, y);
          double sum = 0;
          for (const Sample& s : p) sum += s.color[k];
          const double kept = f_.at(Aov::color, k, x, y);
          out.at(k, x, y) = static_cast<float>(!p.empty() ? sum / p.size() : std::isfinite(kept) ? kept : 0);
        }
    return out;
  }

 private:
  const Pixel& at(int x, int y) const { return pixels_[f_.index(x, y)]; }

  double value(int x, int y, Share half, int slot, int k) const {
    return f_.at(Aov::sample_vectors, slot * SampleVector::size + k, x, y, Statistic::mean, half);
  }

  bool usable(int x, int y) const {
    bool ok = f_.at(Aov::depth, 0, x, y) < kSkyDepth;
    for (int k = 0; k < 3; ++k) ok &= std::isfinite(f_.at(Aov::color, k, x, y));
    return ok;
  }

  Pixel read(int x, int y) const {
    Pixel p;
    if (!usable(x, y)) return p;
    bool same = true;  // both halves
    for (int s = 0; s < 4; ++s)
      for (int k = 0; k < 2; ++k) same &= value(x, y, Share::a, s, k) == value(x, y, Share::b, s, k);
    for (const Share half : {Share::a, Share::b})
      for (int s = 0; s < 4 && (half == Share::a || !same); ++s) {
        bool finite = true, taken = false;
        for (int k = 0; k < SampleVector::size; ++k) {
          finite &= std::isfinite(value(x, y, half, s, k));
          taken |= value(x, y, half, s, k) != 0;
        }
        if (finite && taken) p.push_back(sample(x, y, half, s));
      }
    return p;
  }

  Sample sample(int x, int y, Share half, int slot) const {
    const auto v = [&](int k) { return static_cast<float>(value(x, y, half, slot, k)); };
    Sample s{};
    for (int k = 0; k < 15; ++k) s.v[k] = v(SampleVector::position + k);
    const bool second = v(SampleVector::normal2) != 0 || v(SampleVector::normal2 + 1) != 0 ||
                        v(SampleVector::normal2 + 2) != 0;
    s.v[15] = plan_.is("second_hit", "flagged") && second ? 1 : 0;
    for (int k = 0; k < kRandom; ++k) s.v[kFeatures + k] = v(SampleVector::lens + k);
    for (int k = 0; k < kScreen; ++k) s.v[kFeatures + kRandom + k] = v(SampleVector::screen + k);
    for (int k = 0; k < 3; ++k)
      s.color[k] = s.v[kNumbers - 3 + k] =
          std::min(v(SampleVector::color + k), static_cast<float>(constants_.brightest));
    return s;
  }

  // Distances from the pixel that are drawn with the same probability.
  static std::vector<int> distances(const RpfIteration& i) {
    const auto below = [&](double x) { return std::erfc(-x / i.deviation / std::numbers::sqrt2) / 2; };
    const double all = below(i.radius + 0.5) - below(-i.radius - 0.5);
    std::vector<int> table;
    for (int offset = -i.radius; table.size() < 4096;) {
      const double share = (below(offset + 0.5) - below(-i.radius - 0.5)) / all;
      if (offset < i.radius && share * 4096 <= static_cast<double>(table.size()) + 0.5)
        ++offset;
      else
        table.push_back(offset);
    }
    return table;
  }

  bool is_alike(const Sample& s, const Moments& own) const {
    for (int k = 0; k < kFeatures; ++k) {
      const bool position = k < 3 || (k >= 6 && k < 9);
      const float t = static_cast<float>(position ? constants_.position : constants_.feature);
      const float guard = static_cast<float>(position ? constants_.position_guard : constants_.guard);
      const float inverse = own.inverse_deviation[k];
      const float allowed = std::max(inverse > 0 ? t / inverse : 0.0f, guard);
      if (s.v[k] < own.mean[k] - allowed || s.v[k] > own.mean[k] + allowed) return false;
    }
    return true;
  }

  // Own samples, then, row by row, those that are drawn and alike (algorithm 6).
  std::vector<const Sample*> neighbours(int x, int y, int t, const RpfIteration& i) const {
    const Pixel& own = at(x, y);
    const int n = static_cast<int>(own.size());
    static std::map<std::pair<int, double>, std::vector<int>> tables;
    std::vector<int>& table = tables[{i.radius, i.deviation}];
    if (table.empty()) table = distances(i);
    const int draws = static_cast<int>(static_cast<float>(i.draws) * static_cast<float>(n)) - n;
    const std::uint32_t key =
        mixed(mixed(mixed(mixed(static_cast<std::uint32_t>(plan_["seed"])) + static_cast<std::uint32_t>(t)) +
                    static_cast<std::uint32_t>(x)) +
              static_cast<std::uint32_t>(y));
    std::map<std::pair<int, int>, std::array<bool, 8>> drawn;  // by y, x
    for (int d = 0; d < draws; ++d) {
      const std::uint32_t h = mixed(key + static_cast<std::uint32_t>(d) * 0x9e3779b9u);
      const int dx = table[h % 4096], dy = table[h / 4096 % 4096];
      if (dx != 0 || dy != 0) drawn[{y + dy, x + dx}][(h >> 24) * static_cast<std::uint32_t>(n) / 256] = true;
    }
    std::vector<const Sample*> all;
    for (const Sample& s : own) all.push_back(&s);
    const Moments mine = moments(all, own[0].v);
    for (const auto& [place, slots] : drawn) {
      if (!f_.inside(place.second, place.first)) continue;
      const Pixel& q = at(place.second, place.first);
      for (std::size_t s = 0; s < q.size(); ++s)
        if (slots[s] && is_alike(q[s], mine)) all.push_back(&q[s]);
    }
    return all;
  }

  std::vector<int> buckets(const std::vector<const Sample*>& near, const Moments& m, int k) const {
    std::vector<int> all;
    const float half = 0.5f * static_cast<float>(constants_.buckets);
    const float inverse = m.inverse_deviation[k];
    for (const Sample* s : near)
      all.push_back(std::clamp(static_cast<int>(std::floor(std::fma(s->v[k] - m.mean[k], inverse, half))), 0,
                               constants_.buckets - 1));
    return all;
  }

  RpfDependencies dependencies(const std::vector<const Sample*>& near, const Moments& m) const {
    std::vector<std::vector<int>> x;
    for (int k = 0; k < kNumbers; ++k) x.push_back(buckets(near, m, k));
    const auto sum = [&](int k, int first, int count) {
      double total = 0;
      for (int l = 0; l < count; ++l) total += mutual_information(x[k], x[first + l]);
      return total;
    };
    RpfDependencies d;
    for (int k = 0; k < kFeatures; ++k) {
      d.feature_random.push_back(sum(k, kFeatures, kRandom));
      d.feature_screen.push_back(sum(k, kFeatures + kRandom, kScreen));
      d.color_feature.push_back(sum(k, kNumbers - 3, 3));
    }
    for (int k = 0; k < 3; ++k) {
      d.color_random[k] = sum(kNumbers - 3 + k, kFeatures, kRandom);
      d.color_screen[k] = sum(kNumbers - 3 + k, kFeatures + kRandom, kScreen);
    }
    return d;
  }

  // Equations 5.2, 5.16 to 5.18.
  void filter(Pixel& pixel, const std::vector<const Sample*>& near, const RpfIteration& it) const {
    const Pixel own = pixel;
    std::vector<const Sample*> own_samples(near.begin(),
                                           near.begin() + static_cast<std::ptrdiff_t>(own.size()));
    const Moments m = moments(near, moments(own_samples, own[0].v).mean);
    RpfWeights w = rpf_weights(dependencies(near, m), it.dependence);
    for (double& a : w.alpha) a *= constants_.color_factor;
    for (int k = 0; k < kFeatures; ++k) {
      if (k >= 12 && k < 15) w.beta[k] *= constants_.texture_factor;
      if ((k >= 3 && k < 6) || (k >= 9 && k < 12)) w.beta[k] *= constants_.normal_factor;
    }
    std::array<double, 3> inverse{};
    for (int k = 0; k < 3; ++k) {
      std::vector<double> c;
      for (const Sample* s : near) c.push_back(s->color[k]);
      const double deviation = deviation_of(c);
      inverse[k] = deviation > 0 ? 1 / deviation : 0;
    }
    const double sigma2 = constants_.variance / own.size();
    const double g = std::pow(1 - w.contribution, 2) / (2 * sigma2);
    const auto term = [](double weight, double a, double b, double inverse_deviation) {
      return weight * std::pow((a - b) * inverse_deviation, 2);
    };
    for (std::size_t i = 0; i < own.size(); ++i) {
      double total = 0;
      Rgb sum{};
      for (const Sample* s : near) {
        double e = 0;
        for (int k = 0; k < 3; ++k) e += term(w.alpha[k], own[i].color[k], s->color[k], inverse[k]);
        for (int k = 0; k < kFeatures; ++k)
          e += term(w.beta[k], own[i].v[k], s->v[k], m.inverse_deviation[k]);
        const double weight = std::exp(-g * e);
        total += weight;
        for (int k = 0; k < 3; ++k) sum[k] += weight * s->color[k];
      }
      for (int k = 0; k < 3; ++k) pixel[i].color[k] = sum[k] / total;
    }
    if (constants_.spikes) remove_spikes(pixel);
  }

  static void remove_spikes(Pixel& pixel) {
    std::array<double, 3> mean{}, deviation{}, lost{};
    for (int k = 0; k < 3; ++k) {
      std::vector<double> c;
      for (const Sample& s : pixel) c.push_back(s.color[k]);
      deviation[k] = deviation_of(c);
      for (const double v : c) mean[k] += v / c.size();
    }
    for (Sample& s : pixel) {
      bool spike = false;
      for (int k = 0; k < 3; ++k) spike |= std::abs(s.color[k] - mean[k]) > deviation[k];
      for (int k = 0; k < 3; ++k) {
        if (spike) lost[k] += (s.color[k] - mean[k]) / pixel.size();
        if (spike) s.color[k] = mean[k];
      }
    }
    for (Sample& s : pixel)
      for (int k = 0; k < 3; ++k) s.color[k] += lost[k];
  }

  const FilterPlan& plan_;
  Features f_;
  RpfConstants constants_;
  std::vector<Pixel> pixels_;
};

double entropy(const std::vector<int>& histogram, double n) {
  double h = 0;
  for (const int count : histogram)
    if (count > 0) h -= count / n * std::log2(count / n);
  return h;
}

}  // namespace

double mutual_information(const std::vector<int>& x, const std::vector<int>& y) {
  constexpr int kBuckets = 16;
  std::vector<int> of_x(kBuckets), of_y(kBuckets), of_both(kBuckets * kBuckets);
  for (std::size_t i = 0; i < x.size(); ++i) {
    ++of_x[x[i]];
    ++of_y[y[i]];
    ++of_both[x[i] * kBuckets + y[i]];
  }
  const double n = static_cast<double>(x.size());
  return entropy(of_x, n) + entropy(of_y, n) - entropy(of_both, n);
}

RpfWeights rpf_weights(const RpfDependencies& d, double dependence) {
  constexpr double kEpsilon = 1e-5;
  RpfWeights w;
  double total = kEpsilon;
  for (const double v : d.color_feature) total += v;
  for (int k = 0; k < 3; ++k) {
    total += d.color_random[k] + d.color_screen[k];
    const double fraction = d.color_random[k] / (d.color_random[k] + d.color_screen[k] + kEpsilon);
    w.alpha[k] = std::max(0.0, 1 - dependence * fraction);
    w.contribution += fraction / 3;
  }
  for (std::size_t k = 0; k < d.color_feature.size(); ++k) {
    const double fraction = d.feature_random[k] / (d.feature_random[k] + d.feature_screen[k] + kEpsilon);
    w.beta.push_back(d.color_feature[k] / total * std::max(0.0, 1 - dependence * fraction));
  }
  return w;
}

Image rpf(const FilterPlan& plan, const Image& input) {
  Rpf rpf(plan, input);
  for (int t = 0; t < kRpfIterations; ++t) rpf.iterate(t);
  return rpf.result();
}

}  // namespace tessera::reference
