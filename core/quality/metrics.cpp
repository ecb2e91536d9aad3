// SPDX-License-Identifier: Apache-2.0
#include "core/quality/metrics.h"

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

namespace tessera {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void assert_comparable([[maybe_unused]] const Image& x, [[maybe_unused]] const Image& r) {
  assert(x.region() == r.region() && !x.region().empty() && x.planes() >= 3 && r.planes() >= 3);
}

double squared(double v) { return v * v; }

double rel_square(double x, double r) { return squared(x - r) / (squared(r) + kRelMseEpsilon); }

// relMSE of each pixel: the mean over its channels.
std::vector<double> rel_mse_of_pixels(const Image& x, const Image& r) {
  assert_comparable(x, r);
  std::vector<double> errors(x.plane(0).size());
  for (int c = 0; c < 3; ++c) {
    const auto a = x.plane(c), b = r.plane(c);
    for (std::size_t i = 0; i < errors.size(); ++i) errors[i] += rel_square(a[i], b[i]) / 3.0;
  }
  return errors;
}

double mean(const std::vector<double>& values) {
  double sum = 0;
  for (double v : values) sum += v;
  return sum / static_cast<double>(values.size());
}

// One of the two directions in which tiles have borders: across columns or across rows.
struct Lines {
  double border_sum = 0, between_sum = 0;
  std::int64_t borders = 0, betweens = 0;
};

int modulo(int v, int m) { return ((v % m) + m) % m; }

// `along` steps from pixel to pixel across the lines: {1, 0} for vertical lines.
Lines jumps(const Image& x, const Image& r, int edge, Size along) {
  const Region area = x.region();
  Lines lines;
  for (int py = area.y0 + along.height; py < area.y1; ++py)
    for (int px = area.x0 + along.width; px < area.x1; ++px) {
      const int at = modulo(along.width ? px : py, edge);
      const bool border = at == 0, between = at == edge / 2 && !border;
      if (!border && !between) continue;
      double jump = 0;
      for (int c = 0; c < 3; ++c) {
        const int qx = px - along.width, qy = py - along.height;
        jump += std::abs((double(x.at(c, px, py)) - r.at(c, px, py)) -
                         (double(x.at(c, qx, qy)) - r.at(c, qx, qy)));
      }
      (border ? lines.border_sum : lines.between_sum) += jump;
      ++(border ? lines.borders : lines.betweens);
    }
  return lines;
}

constexpr int kWindow = 11;

std::array<double, kWindow> gaussian() {
  std::array<double, kWindow> weights;
  double sum = 0;
  for (int i = 0; i < kWindow; ++i) sum += weights[i] = std::exp(-0.5 * squared((i - kWindow / 2) / 1.5));
  for (double& w : weights) w /= sum;
  return weights;
}

// Planes of width x height doubles, filtered where the window lies inside: the result has kWindow - 1 less of
// each.
std::vector<double> blurred(const std::vector<double>& in, Size size) {
  static const std::array<double, kWindow> weights = gaussian();
  const int width = size.width - kWindow + 1, height = size.height - kWindow + 1;
  std::vector<double> rows(static_cast<std::size_t>(width) * size.height);
  for (int y = 0; y < size.height; ++y)
    for (int k = 0; k < kWindow; ++k) {
      const double* from = in.data() + static_cast<std::size_t>(y) * size.width + k;
      double* to = rows.data() + static_cast<std::size_t>(y) * width;
      for (int x = 0; x < width; ++x) to[x] += weights[k] * from[x];
    }
  std::vector<double> out(static_cast<std::size_t>(width) * height);
  for (int y = 0; y < height; ++y)
    for (int k = 0; k < kWindow; ++k) {
      const double* from = rows.data() + static_cast<std::size_t>(y + k) * width;
      double* to = out.data() + static_cast<std::size_t>(y) * width;
      for (int x = 0; x < width; ++x) to[x] += weights[k] * from[x];
    }
  return out;
}

std::vector<double> product(std::span<const float> a, std::span<const float> b) {
  std::vector<double> out(a.size());
  for (std::size_t i = 0; i < out.size(); ++i) out[i] = double(a[i]) * b[i];
  return out;
}

double ssim_of_plane(std::span<const float> x, std::span<const float> r, Size size) {
  constexpr double kC1 = 0.01 * 0.01, kC2 = 0.03 * 0.03;
  const auto mx = blurred({x.begin(), x.end()}, size), mr = blurred({r.begin(), r.end()}, size);
  const auto xx = blurred(product(x, x), size), rr = blurred(product(r, r), size);
  const auto xr = blurred(product(x, r), size);
  double sum = 0;
  for (std::size_t i = 0; i < mx.size(); ++i) {
    const double sx = xx[i] - mx[i] * mx[i], sr = rr[i] - mr[i] * mr[i], sxr = xr[i] - mx[i] * mr[i];
    sum += (2 * mx[i] * mr[i] + kC1) * (2 * sxr + kC2) /
           ((mx[i] * mx[i] + mr[i] * mr[i] + kC1) * (sx + sr + kC2));
  }
  return sum / static_cast<double>(mx.size());
}

}  // namespace

double rel_mse(const Image& x, const Image& r) { return mean(rel_mse_of_pixels(x, r)); }

double rel_mse_trimmed(const Image& x, const Image& r) {
  std::vector<double> errors = rel_mse_of_pixels(x, r);
  if (!std::ranges::all_of(errors, [](double e) { return std::isfinite(e); })) return kNan;
  const auto kept = errors.end() - static_cast<std::ptrdiff_t>(errors.size() / 1000);
  if (kept != errors.end()) std::nth_element(errors.begin(), kept, errors.end());
  errors.erase(kept, errors.end());
  return mean(errors);
}

double mse(const Image& x, const Image& r) {
  assert_comparable(x, r);
  double sum = 0;
  for (int c = 0; c < 3; ++c) {
    const auto a = x.plane(c), b = r.plane(c);
    for (std::size_t i = 0; i < a.size(); ++i) sum += squared(double(a[i]) - b[i]);
  }
  return sum / (3.0 * static_cast<double>(x.region().area()));
}

double rmse(const Image& x, const Image& r) { return std::sqrt(mse(x, r)); }

Image displayed(const Image& linear, float exposure) {
  assert(linear.planes() >= 3);
  Image out(linear.region(), 3);
  const float scale = std::exp2(exposure);
  for (int c = 0; c < 3; ++c) {
    const auto from = linear.plane(c);
    const auto to = out.plane(c);
    for (std::size_t i = 0; i < to.size(); ++i) {
      const float v = std::clamp(from[i] * scale, 0.0f, 1.0f);
      to[i] = v <= 0.0031308f ? 12.92f * v : 1.055f * std::pow(v, 1.0f / 2.4f) - 0.055f;
    }
  }
  return out;
}

double ssim(const Image& x, const Image& r, float exposure) {
  assert_comparable(x, r);
  const Size size{x.region().width(), x.region().height()};
  if (std::min(size.width, size.height) < kWindow) return kNan;
  const Image a = displayed(x, exposure), b = displayed(r, exposure);
  double sum = 0;
  for (int c = 0; c < 3; ++c) sum += ssim_of_plane(a.plane(c), b.plane(c), size);
  return sum / 3;
}

double seam(const Image& x, const Image& r, Size tile) {
  assert_comparable(x, r);
  assert(tile.width > 0 && tile.height > 0);
  double at_borders = 0, between = 0;
  bool any = false;
  for (const Lines& lines : {jumps(x, r, tile.width, {1, 0}), jumps(x, r, tile.height, {0, 1})}) {
    if (lines.borders == 0 || lines.betweens == 0) continue;
    any = true;
    at_borders += lines.border_sum / static_cast<double>(lines.borders);
    between += lines.between_sum / static_cast<double>(lines.betweens);
  }
  if (!any) return kNan;
  if (at_borders == 0 && between == 0) return 1.0;
  return at_borders / between;
}

Image rel_mse_map(const Image& x, const Image& r) {
  const std::vector<double> errors = rel_mse_of_pixels(x, r);
  Image map(x.region(), 1);
  std::ranges::transform(errors, map.plane(0).begin(), [](double e) { return static_cast<float>(e); });
  return map;
}

}  // namespace tessera
