// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/guided.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "tests/reference/surface.h"

namespace tessera::reference {
namespace {

constexpr int kGuides = 4;
using Vector = std::array<double, kGuides>;
using Matrix = std::array<Vector, kGuides>;

// x of m x = b, by elimination with pivots.
Vector solved(Matrix m, Vector b) {
  for (int k = 0; k < kGuides; ++k) {
    int pivot = k;
    for (int i = k + 1; i < kGuides; ++i)
      if (std::abs(m[i][k]) > std::abs(m[pivot][k])) pivot = i;
    std::swap(m[k], m[pivot]);
    std::swap(b[k], b[pivot]);
    for (int i = 0; i < kGuides; ++i) {
      if (i == k) continue;
      const double f = m[i][k] / m[k][k];
      for (int j = k; j < kGuides; ++j) m[i][j] -= f * m[k][j];
      b[i] -= f * b[k];
    }
  }
  for (int k = 0; k < kGuides; ++k) b[k] /= m[k][k];
  return b;
}

class Guided {
 public:
  Guided(const FilterPlan& plan, const Image& input)
      : plan_(plan), f_(plan, input), radius_(static_cast<int>(plan["radius"])) {
    fits_.resize(static_cast<std::size_t>(input.region().area()));
    each_valid(f_, [&](int x, int y) { fits_[f_.index(x, y)] = fit(x, y); });
  }

  const Features& features() const { return f_; }

  Rgb result(int x, int y) const {
    Rgb total{};
    int count = 0;
    const Vector g = guide(x, y);
    each_tap(f_, x, y, radius_, 1, [&](int, int, int qx, int qy) {
      ++count;
      for (int c = 0; c < 3; ++c) {
        const Line& line = fits_[f_.index(qx, qy)][c];
        total[c] += line.constant;
        for (int k = 0; k < kGuides; ++k) total[c] += line.slopes[k] * g[k];
      }
    });
    for (double& v : total) v = std::max(0.0, v / count);
    return total;
  }

 private:
  struct Line {
    Vector slopes{};
    double constant = 0;
  };

  Vector guide(int x, int y) const {
    const Rgb n = f_.unit_normal(x, y);
    const double scale = plan_["depth_scale"] > 0 ? plan_["depth_scale"] : 1;
    return {n[0], n[1], n[2], f_.at(Aov::depth, 0, x, y) / scale};
  }
  Rgb light(int x, int y) const {
    const Rgb lit = difference(f_.rgb(Aov::color, x, y), f_.rgb(Aov::emission, x, y));
    const Rgb albedo = floored(f_.rgb(Aov::albedo, x, y));
    return {lit[0] / albedo[0], lit[1] / albedo[1], lit[2] / albedo[2]};
  }

  // Least squares over the window about (x, y), the slopes' squares weighed by epsilon.
  std::array<Line, 3> fit(int x, int y) const {
    int count = 0;
    Vector g_mean{};
    Rgb l_mean{};
    each_tap(f_, x, y, radius_, 1, [&](int, int, int qx, int qy) {
      ++count;
      for (int k = 0; k < kGuides; ++k) g_mean[k] += guide(qx, qy)[k];
      for (int c = 0; c < 3; ++c) l_mean[c] += light(qx, qy)[c];
    });
    for (double& v : g_mean) v /= count;
    for (double& v : l_mean) v /= count;
    Matrix of_guides{};
    std::array<Vector, 3> of_light{};
    each_tap(f_, x, y, radius_, 1, [&](int, int, int qx, int qy) {
      Vector g = guide(qx, qy);
      const Rgb l = difference(light(qx, qy), l_mean);
      for (int k = 0; k < kGuides; ++k) g[k] -= g_mean[k];
      for (int k = 0; k < kGuides; ++k) {
        for (int j = 0; j < kGuides; ++j) of_guides[k][j] += g[k] * g[j] / count;
        for (int c = 0; c < 3; ++c) of_light[c][k] += g[k] * l[c] / count;
      }
    });
    for (int k = 0; k < kGuides; ++k) of_guides[k][k] += plan_["epsilon"];
    std::array<Line, 3> lines;
    for (int c = 0; c < 3; ++c) {
      lines[c].slopes = solved(of_guides, of_light[c]);
      lines[c].constant = l_mean[c];
      for (int k = 0; k < kGuides; ++k) lines[c].constant -= lines[c].slopes[k] * g_mean[k];
    }
    return lines;
  }

  const FilterPlan& plan_;
  Features f_;
  int radius_;
  std::vector<std::array<Line, 3>> fits_;
};

}  // namespace

Image guided(const FilterPlan& plan, const Image& input) {
  const Guided filter(plan, input);
  const Features& f = filter.features();
  const Region& r = input.region();
  Image out(r, 3);
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      const Rgb light = f.valid(x, y) ? filter.result(x, y) : Rgb{};
      for (int k = 0; k < 3; ++k) {
        const double color = f.at(Aov::color, k, x, y);
        const double lit = light[k] * floored(f.rgb(Aov::albedo, x, y))[k];
        out.at(k, x, y) = static_cast<float>(f.valid(x, y)          ? lit + f.at(Aov::emission, k, x, y)
                                             : std::isfinite(color) ? color
                                                                    : 0.0);
      }
    }
  return out;
}

}  // namespace tessera::reference
