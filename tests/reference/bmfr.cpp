// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/bmfr.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <map>
#include <utility>

#include "core/filter/blocks.h"
#include "core/filter/descriptions.h"
#include "tests/reference/features.h"
#include "tests/reference/history.h"
#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

using Row = std::vector<double>;
using Place = std::pair<int, int>;

int quotient(int a, int b) { return static_cast<int>(std::floor(static_cast<double>(a) / b)); }

int mirrored(int i, int begin, int end) {
  while (i < begin || i >= end) i = i < begin ? 2 * begin - 1 - i : 2 * end - 1 - i;
  return i;
}

std::uint32_t pcg(std::uint32_t v) {
  const std::uint32_t state = v * 747796405u + 2891336453u;
  const std::uint32_t word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  return (word >> 22u) ^ word;
}

// Least squares by Gaussian elimination of the normal equations; rows of a end in three right-hand sides.
std::vector<Rgb> solved(std::vector<Row> a) {
  const std::size_t n = a.size();
  for (std::size_t k = 0; k < n; ++k) {
    std::size_t pivot = k;
    for (std::size_t i = k + 1; i < n; ++i)
      if (std::abs(a[i][k]) > std::abs(a[pivot][k])) pivot = i;
    std::swap(a[k], a[pivot]);
    for (std::size_t i = 0; i < n; ++i) {
      if (i == k) continue;
      const double f = a[i][k] / a[k][k];
      for (std::size_t j = k; j < n + 3; ++j) a[i][j] -= f * a[k][j];
    }
  }
  std::vector<Rgb> x(n);
  for (std::size_t k = 0; k < n; ++k)
    for (int c = 0; c < 3; ++c) x[k][c] = a[k][n + c] / a[k][k];
  return x;
}

// The light of each pixel: over the frames, and how many they are; what was filtered of it before.
struct Accumulated {
  Rgb light{}, before{};
  double frames = 0;
};

class Accumulation {
 public:
  Accumulation(const FilterPlan& plan, const Features& f, const Image& history)
      : plan_(plan), f_(f), history_(history), first_of_filtered_(surfaces_move(plan.parameters) ? 12 : 10) {}

  Accumulated at(int x, int y) const {
    const Rgb lit = difference(f_.rgb(Aov::color, x, y), f_.rgb(Aov::emission, x, y));
    const Rgb albedo = floored(f_.rgb(Aov::albedo, x, y));
    Accumulated now{{lit[0] / albedo[0], lit[1] / albedo[1], lit[2] / albedo[2]}, {}, 1};
    if (!with_history(plan_.parameters)) return now;
    const auto pixels = past_pixels(
        f_, history_.region(), x, y, [&](int qx, int qy) { return plausible(qx, qy) && same(x, y, qx, qy); },
        false);
    if (pixels.empty()) return now;
    Accumulated then;
    then.frames = mean_of_plane(pixels, history_, 3);
    for (int c = 0; c < 3; ++c) {
      then.light[c] = mean_of_plane(pixels, history_, c);
      then.before[c] = mean_of_plane(pixels, history_, first_of_filtered_ + c);
    }
    const double a = std::max(1 / (then.frames + 1), plan_["alpha"]);
    for (int c = 0; c < 3; ++c) then.light[c] = a * now.light[c] + (1 - a) * then.light[c];
    then.frames = std::min(255.0, std::nearbyint(then.frames) + 1);
    return then;
  }

 private:
  bool plausible(int x, int y) const {
    for (int c = 0; c < 4; ++c)
      if (!(std::abs(history_.at(c, x, y)) <= 1e32f)) return false;
    for (int k = 4; k < first_of_filtered_; ++k)
      if (!(std::abs(history_.at(k, x, y)) <= 1e32f)) return false;
    for (int c = 0; c < 3; ++c)
      if (!(std::abs(history_.at(first_of_filtered_ + c, x, y)) <= 1e32f)) return false;
    return history_.at(3, x, y) >= 1 && history_.at(3, x, y) <= 255;
  }
  bool same(int x, int y, int qx, int qy) const {
    const auto past = [&](int plane) { return double(history_.at(plane, qx, qy)); };
    const double limit = plan_["distance_p"] > 0
                             ? std::pow(plan_["distance_p"], 2)
                             : std::pow(plan_["limit_p"], 2) * squared_footprint(f_, x, y);
    const double turn = squared(difference({past(4), past(5), past(6)}, f_.rgb(Aov::normal, x, y)));
    const double distance = squared(difference({past(7), past(8), past(9)}, f_.rgb(Aov::position, x, y)));
    bool near = distance <= limit;
    if (surfaces_move(plan_.parameters))
      near = near || (std::pow(past(10) - f_.at(Aov::previous_depth, 0, x, y), 2) <= limit &&
                      past(11) == f_.at(Aov::object_id, 0, x, y));
    return near && turn < std::pow(plan_["limit_n"], 2);
  }

  const FilterPlan& plan_;
  const Features& f_;
  const Image& history_;
  int first_of_filtered_;
};

class Bmfr {
 public:
  Bmfr(const FilterPlan& plan, const Image& input, const Image& history)
      : plan_(plan),
        f_(plan, input),
        grid_(block_grid(plan)),
        columns_(block_features(plan.parameters)),
        count_(1 + static_cast<std::size_t>(columns_.columns())),
        stochastic_(plan["regularisation"] == 1),
        accumulated_(static_cast<std::size_t>(input.region().area())) {
    const Accumulation accumulation(plan, f_, history);
    each_valid(f_, [&](int x, int y) { accumulated_[f_.index(x, y)] = accumulation.at(x, y); });
  }

  const Features& features() const { return f_; }
  const Accumulated& accumulated(int x, int y) const { return accumulated_[f_.index(x, y)]; }

  // Light at a valid pixel: the mean of the grids' fits, weighted by the distances to their blocks' borders.
  Rgb light(int x, int y) {
    double sum = 0;
    Rgb total{};
    constexpr Place kHalves[] = {{0, 0}, {1, 1}, {1, 0}, {0, 1}};
    for (int g = 0; g < grids_taken(plan_.parameters); ++g) {
      const int ox = grid_.x + kHalves[g].first * grid_.cell(),
                oy = grid_.y + kHalves[g].second * grid_.cell();
      const Place corner{ox + grid_.edge * quotient(x - ox, grid_.edge),
                         oy + grid_.edge * quotient(y - oy, grid_.edge)};
      const double w = tent(x - corner.first) * tent(y - corner.second);
      const Rgb fit = at(fit_of(corner), features_of(x, y), x - corner.first, y - corner.second);
      sum += w;
      for (int c = 0; c < 3; ++c) total[c] += w * fit[c];
    }
    for (double& v : total) v = std::max(0.0, v / sum);
    return total;
  }

 private:
  using Raw = std::array<double, 7>;  // normal, position, material
  struct Fit {
    Raw low{}, high{};
    std::vector<Rgb> coefficients;
  };

  // The columns at the place (i, j) of the block; axes in a basis in which the block reaches from -1 to 1.
  Row row(const Fit& fit, const Raw& raw, int i, int j) const {
    const auto scaled = [&](int k) {
      const double extent = (fit.high[k] - fit.low[k]) / 2, middle = (fit.high[k] + fit.low[k]) / 2;
      return extent > 0 ? (raw[k] - middle) / extent : 0;
    };
    Row t{1};
    for (int power = 1; power <= columns_.normals; ++power)
      for (int c = 0; c < 3; ++c) t.push_back(std::pow(raw[c], power));
    for (int power = 1; power <= columns_.positions; ++power)
      for (int c = 0; c < 3; ++c) t.push_back(std::pow(scaled(3 + c), power));
    if (columns_.gradients)
      for (const int place : {i, j}) t.push_back(2.0 * place / (grid_.edge - 1) - 1);
    if (columns_.material) t.push_back(scaled(6));
    return t;
  }
  Rgb at(const Fit& fit, const Raw& raw, int i, int j) const {
    Rgb sum{};
    const Row t = row(fit, raw, i, j);
    for (std::size_t k = 0; k < t.size(); ++k)
      for (int c = 0; c < 3; ++c) sum[c] += t[k] * fit.coefficients[k][c];
    return sum;
  }

  double tent(int i) const { return std::min(i, grid_.edge - 1 - i) + 0.5; }

  Raw features_of(int x, int y) const {
    Raw raw{};
    for (int c = 0; c < 3; ++c)
      raw[c] = f_.at(Aov::normal, c, x, y), raw[3 + c] = f_.at(Aov::position, c, x, y);
    if (columns_.material) raw[6] = f_.at(Aov::material_id, 0, x, y);
    return raw;
  }

  Place source(int x, int y) const {
    const Region& r = f_.region();
    return {mirrored(x, r.x0, r.x1), mirrored(y, r.y0, r.y1)};
  }

  // Accumulated light of a cell's pixels, row by row, luminance twice clamped to mean + k deviations.
  const std::vector<Rgb>& clamped(Place corner) {
    const auto [entry, fresh] = cells_.try_emplace(corner);
    std::vector<Rgb>& cell = entry->second;
    if (!fresh) return cell;
    std::vector<Rgb*> valid;
    cell.resize(static_cast<std::size_t>(grid_.cell()) * grid_.cell());
    for (int j = 0, k = 0; j < grid_.cell(); ++j)
      for (int i = 0; i < grid_.cell(); ++i, ++k) {
        const auto [x, y] = source(corner.first + i, corner.second + j);
        if (!f_.valid(x, y)) continue;
        cell[k] = accumulated(x, y).light;
        valid.push_back(&cell[k]);
      }
    for (int round = 0; round < 2; ++round) {
      double mean = 0, variance = 0;
      for (const Rgb* c : valid) mean += luminance(*c) / static_cast<double>(valid.size());
      for (const Rgb* c : valid)
        variance += std::pow(luminance(*c) - mean, 2) / static_cast<double>(valid.size());
      const double limit = std::max(0.0, mean + plan_["clamp"] * std::sqrt(variance));
      for (Rgb* c : valid)
        if (const double l = luminance(*c); l > limit)
          for (double& v : *c) v *= limit / l;
    }
    return cell;
  }

  // Equal for all blocks.
  double noise(int column, int i, int j) const {
    const int frame = static_cast<int>(plan_["frame"]);
    const std::uint32_t key = ((frame * 16u + column) * grid_.edge + j) * grid_.edge + i;
    return plan_["epsilon"] * (2.0 * (pcg(key) >> 8) / (1 << 24) - 1);
  }

  const Fit& fit_of(Place corner) {
    const auto [entry, fresh] = fits_.try_emplace(corner);
    Fit& fit = entry->second;
    if (!fresh) return fit;
    struct Pixel {
      int i, j;
      Raw raw;
      Rgb light;
    };
    std::vector<Pixel> pixels;
    fit.low.fill(INFINITY);
    fit.high.fill(-INFINITY);
    const int edge = grid_.edge, half = grid_.cell();
    for (int j = 0; j < edge; ++j)
      for (int i = 0; i < edge; ++i) {
        const auto [x, y] = source(corner.first + i, corner.second + j);
        if (!f_.valid(x, y)) continue;
        const auto& cell = clamped({corner.first + i / half * half, corner.second + j / half * half});
        pixels.push_back({i, j, features_of(x, y), cell[j % half * half + i % half]});
        for (int k = 0; k < 7; ++k) {
          fit.low[k] = std::min(fit.low[k], pixels.back().raw[k]);
          fit.high[k] = std::max(fit.high[k], pixels.back().raw[k]);
        }
      }
    std::vector<Row> sums(count_, Row(count_ + 3));
    for (const Pixel& p : pixels) {
      Row t = row(fit, p.raw, p.i, p.j);
      for (std::size_t a = 1; a < count_; ++a) t[a] += stochastic_ ? noise(static_cast<int>(a), p.i, p.j) : 0;
      for (std::size_t a = 0; a < count_; ++a) {
        for (std::size_t b = 0; b < count_; ++b) sums[a][b] += t[a] * t[b];
        for (int c = 0; c < 3; ++c) sums[a][count_ + c] += t[a] * p.light[c];
      }
    }
    const double count = static_cast<double>(pixels.size());
    if (stochastic_ && pixels.size() < 2 * count_) {
      fit.coefficients.resize(count_);
      for (int c = 0; c < 3; ++c) fit.coefficients[0][c] = sums[0][count_ + c] / count;
      return fit;
    }
    if (!stochastic_)
      for (std::size_t a = 1; a < count_; ++a) sums[a][a] += count * std::pow(plan_["epsilon"], 2) / 3;
    fit.coefficients = solved(sums);
    return fit;
  }

  const FilterPlan& plan_;
  Features f_;
  BlockGrid grid_;
  BlockFeatures columns_;
  std::size_t count_;
  bool stochastic_;
  std::vector<Accumulated> accumulated_;
  std::map<Place, std::vector<Rgb>> cells_;  // by their first pixel
  std::map<Place, Fit> fits_;
};

// The planes that the next frame finds, as they lie in its history.
void keep(const FilterPlan& plan, const Features& f, const Accumulated& a, const Rgb& filtered, int x, int y,
          Image& out) {
  const Rgb n = f.rgb(Aov::normal, x, y), p = f.rgb(Aov::position, x, y);
  std::vector<double> kept{a.light[0], a.light[1], a.light[2], a.frames, n[0], n[1], n[2], p[0], p[1], p[2]};
  if (surfaces_move(plan.parameters)) {
    kept.push_back(f.at(Aov::depth, 0, x, y));
    kept.push_back(f.at(Aov::object_id, 0, x, y));
  }
  kept.insert(kept.end(), filtered.begin(), filtered.end());
  for (std::size_t k = 0; k < kept.size(); ++k)
    out.at(3 + static_cast<int>(k), x, y) = static_cast<float>(kept[k]);
}

}  // namespace

Image bmfr(const FilterPlan& plan, const Image& input, const Image& history) {
  Bmfr bmfr(plan, input, history);
  const Features& f = bmfr.features();
  const Region& r = input.region();
  Image out(r, 3 + plan.history());
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const bool valid = f.valid(x, y);
      Rgb light = valid ? bmfr.light(x, y) : Rgb{};
      const Rgb albedo = floored(f.rgb(Aov::albedo, x, y));
      if (valid && with_history(plan.parameters)) {
        const Accumulated& a = bmfr.accumulated(x, y);
        const double share = std::max(1 / a.frames, plan["alpha_filtered"]);
        for (int k = 0; k < 3; ++k) light[k] = share * light[k] + (1 - share) * a.before[k];
        keep(plan, f, a, light, x, y, out);
      }
      for (int k = 0; k < 3; ++k) {
        const double color = f.at(Aov::color, k, x, y);
        out.at(k, x, y) = static_cast<float>(valid ? light[k] * albedo[k] + f.at(Aov::emission, k, x, y)
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
    }
  return out;
}

}  // namespace tessera::reference
