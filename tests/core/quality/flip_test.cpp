// SPDX-License-Identifier: Apache-2.0
// FLIP against a second version of it, written from the paper's formulas in double precision with
// two-dimensional kernels and the opponent colours as printed; and against what can be worked out by hand.
#include "core/quality/flip.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "tests/core/quality/pictures.h"

namespace tessera {
namespace {

constexpr double kPi = std::numbers::pi;
using Vec = std::array<double, 3>;
using Planes = std::array<std::vector<double>, 3>;

// sRGB to XYZ as IEC 61966-2-1 prints it, to more digits (Lindbloom), and its inverse.
constexpr double kToXyz[3][3] = {
    {0.4124564, 0.3575761, 0.1804375}, {0.2126729, 0.7151522, 0.0721750}, {0.0193339, 0.1191920, 0.9503041}};
constexpr double kToRgb[3][3] = {{3.2404542, -1.5371385, -0.4985314},
                                 {-0.9692660, 1.8760108, 0.0415560},
                                 {0.0556434, -0.2040259, 1.0572252}};
Vec times(const double (&m)[3][3], const Vec& v) {
  Vec out{};
  for (int i = 0; i < 3; ++i)
    for (int k = 0; k < 3; ++k) out[i] += m[i][k] * v[k];
  return out;
}
const Vec kWhiteXyz = times(kToXyz, {1, 1, 1});

Vec hunt_lab(const Vec& rgb) {
  const Vec xyz = times(kToXyz, rgb);
  const auto f = [](double t) {
    return t > std::pow(6.0 / 29, 3) ? std::cbrt(t) : (841.0 / 108) * t + 4.0 / 29;
  };
  const double x = f(xyz[0] / kWhiteXyz[0]), y = f(xyz[1] / kWhiteXyz[1]), z = f(xyz[2] / kWhiteXyz[2]);
  const double l = 116 * y - 16;
  return {l, 0.01 * l * 500 * (x - y), 0.01 * l * 200 * (y - z)};
}
double hyab(const Vec& a, const Vec& b) {
  return std::abs(a[0] - b[0]) + std::hypot(a[1] - b[1], a[2] - b[2]);
}

double color_error(const Vec& rgb, const Vec& reference) {
  const double most = std::pow(hyab(hunt_lab({0, 1, 0}), hunt_lab({0, 0, 1})), 0.7);
  const double e = std::pow(hyab(hunt_lab(rgb), hunt_lab(reference)), 0.7), knee = 0.4 * most;
  return e < knee ? e * 0.95 / knee : 0.95 + (e - knee) / (most - knee) * 0.05;
}

using Kernel = std::vector<std::vector<double>>;  // [y + radius][x + radius]
template <typename F>
Kernel kernel_of(int radius, const F& f) {
  Kernel k(static_cast<std::size_t>(2 * radius + 1),
           std::vector<double>(static_cast<std::size_t>(2 * radius + 1)));
  double positive = 0, negative = 0;
  for (int y = -radius; y <= radius; ++y)
    for (int x = -radius; x <= radius; ++x) {
      const double v = k[static_cast<std::size_t>(y + radius)][static_cast<std::size_t>(x + radius)] =
          f(x, y);
      (v > 0 ? positive : negative) += v;
    }
  for (auto& row : k)
    for (double& v : row) v /= v > 0 ? positive : -negative;
  return k;
}

std::vector<double> convolved(const std::vector<double>& in, Size size, const Kernel& k,
                              bool transposed = false) {
  std::vector<double> out(in.size());
  const int radius = static_cast<int>(k.size() / 2);
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      double sum = 0;
      for (int v = -radius; v <= radius; ++v)
        for (int u = -radius; u <= radius; ++u) {
          const int px = std::clamp(x + u, 0, size.width - 1), py = std::clamp(y + v, 0, size.height - 1);
          const int ku = transposed ? v : u, kv = transposed ? u : v;
          sum += in[static_cast<std::size_t>(py * size.width + px)] *
                 k[static_cast<std::size_t>(kv + radius)][static_cast<std::size_t>(ku + radius)];
        }
      out[static_cast<std::size_t>(y * size.width + x)] = sum;
    }
  return out;
}

Kernel sensitivity(int radius, double ppd, double a1, double b1, double a2, double b2) {
  return kernel_of(radius, [=](int x, int y) {
    const double d2 = (x * x + y * y) / (ppd * ppd);
    return a1 * std::sqrt(kPi / b1) * std::exp(-kPi * kPi * d2 / b1) +
           a2 * std::sqrt(kPi / b2) * std::exp(-kPi * kPi * d2 / b2);
  });
}

struct SlowFlip {
  double ppd;
  Size size;

  Planes ycxcz(const Image& rgb) const {
    Planes out;
    for (std::size_t i = 0; i < rgb.plane(0).size(); ++i) {
      Vec v{};
      for (int c = 0; c < 3; ++c) v[c] = std::clamp(double{rgb.plane(c)[i]}, 0.0, 1.0);
      const Vec xyz = times(kToXyz, v);
      const double x = xyz[0] / kWhiteXyz[0], y = xyz[1] / kWhiteXyz[1], z = xyz[2] / kWhiteXyz[2];
      out[0].push_back(116 * y - 16), out[1].push_back(500 * (x - y)), out[2].push_back(200 * (y - z));
    }
    return out;
  }
  Planes seen(const Planes& in) const {
    const int radius = static_cast<int>(std::ceil(3 * std::sqrt(0.04 / (2 * kPi * kPi)) * ppd));
    return {convolved(in[0], size, sensitivity(radius, ppd, 1, 0.0047, 0, 1e-5)),
            convolved(in[1], size, sensitivity(radius, ppd, 1, 0.0053, 0, 1e-5)),
            convolved(in[2], size, sensitivity(radius, ppd, 34.1, 0.04, 13.5, 0.025))};
  }
  Vec rgb_at(const Planes& p, std::size_t i) const {
    const double y = (p[0][i] + 16) / 116, x = y + p[1][i] / 500, z = y - p[2][i] / 200;
    Vec rgb = times(kToRgb, {x * kWhiteXyz[0], y * kWhiteXyz[1], z * kWhiteXyz[2]});
    for (double& v : rgb) v = std::clamp(v, 0.0, 1.0);
    return rgb;
  }
  std::vector<double> feature(const Planes& p, bool point) const {
    std::vector<double> y;
    for (const double v : p[0]) y.push_back((v + 16) / 116);
    const double sigma = 0.5 * 0.082 * ppd;
    const int radius = static_cast<int>(std::ceil(3 * sigma));
    const Kernel k = kernel_of(radius, [=](int u, int v) {
      const double g = std::exp(-(u * u + v * v) / (2 * sigma * sigma));
      return (point ? u * u / (sigma * sigma) - 1 : -u) * g;
    });
    const auto across = convolved(y, size, k), down = convolved(y, size, k, true);
    for (std::size_t i = 0; i < y.size(); ++i) y[i] = std::hypot(across[i], down[i]);
    return y;
  }
  std::vector<double> of(const Image& x, const Image& r) const {
    const Planes a = ycxcz(x), b = ycxcz(r), sa = seen(a), sb = seen(b);
    const auto ea = feature(a, false), eb = feature(b, false), pa = feature(a, true), pb = feature(b, true);
    std::vector<double> out;
    for (std::size_t i = 0; i < ea.size(); ++i) {
      const double ef =
          std::sqrt(std::max(std::abs(ea[i] - eb[i]), std::abs(pa[i] - pb[i])) / std::numbers::sqrt2);
      out.push_back(std::pow(color_error(rgb_at(sa, i), rgb_at(sb, i)), 1 - ef));
    }
    return out;
  }
};

// Squares of some colours under noise: edges, points, flat parts and colours beyond the screen.
Image squares(const Region& region, unsigned seed, float shift) {
  Image image = noise(region, seed, -0.1f, 0.3f);
  for (int c = 0; c < 3; ++c)
    for (int y = region.y0; y < region.y1; ++y)
      for (int x = region.x0; x < region.x1; ++x)
        image.at(c, x, y) *= ((x / 9 + y / 7 + c) % 3 + shift) * (x > 20 ? 1.0f : 0.0f);
  return image;
}

TEST(Flip, EqualsItsFormulas) {
  const Region frame{3, -2, 44, 31};
  const Image x = squares(frame, 1, 0.2f), r = squares(frame, 2, 0.1f);
  for (const double ppd : {kPixelsPerDegree, 31.0}) {
    const ErrorMap fast = flip_map(x, r, flip_kernels(ppd));
    const std::vector<double> slow = SlowFlip{ppd, {frame.width(), frame.height()}}.of(x, r);
    double most = 0, least = 1;
    for (std::size_t i = 0; i < slow.size(); ++i) {
      // Small differences of nearly equal pixels are raised to the power of 0.7: floats, and the digits of
      // the two matrices (5 or so), are what is left.
      EXPECT_NEAR(fast.values[i], slow[i], 1e-3) << i;
      most = std::max(most, slow[i]), least = std::min(least, slow[i]);
    }
    EXPECT_NEAR(mean(fast), std::accumulate(slow.begin(), slow.end(), 0.0) / double(slow.size()), 1e-4);
    EXPECT_GT(most, 0.3);
    EXPECT_LT(least, 0.05);
  }
}

TEST(Flip, KernelsHaveTheStatedSumsReachAndSymmetry) {
  EXPECT_NEAR(kPixelsPerDegree, 67.02, 0.005);
  const FlipKernels k = flip_kernels(kPixelsPerDegree);
  for (const auto* kernel : {&k.achromatic, &k.red_green, &k.blue_yellow[0], &k.blue_yellow[1], &k.smooth}) {
    EXPECT_NEAR(std::accumulate(kernel->begin(), kernel->end(), 0.0), 1, 1e-12);
    EXPECT_TRUE(std::equal(kernel->begin(), kernel->end(), kernel->rbegin()));
  }
  EXPECT_EQ(k.achromatic.size(), 21u);
  EXPECT_EQ(k.blue_yellow[0].size(), 21u);
  EXPECT_EQ(k.edge.size(), 19u);
  for (const auto* kernel : {&k.edge, &k.point}) {
    double positive = 0, negative = 0;
    for (const double v : *kernel) (v > 0 ? positive : negative) += v;
    EXPECT_NEAR(positive, 1, 1e-12);
    EXPECT_NEAR(negative, -1, 1e-12);
  }
  for (std::size_t i = 0; i < 19; ++i) {
    EXPECT_NEAR(k.edge[i], -k.edge[18 - i], 1e-15);
    EXPECT_NEAR(k.point[i], k.point[18 - i], 1e-15);
  }
}

TEST(Flip, IsZeroForEqualImagesAndTheSameBothWays) {
  const Region frame{0, 0, 40, 30};
  const Image a = squares(frame, 3, 0.3f), b = squares(frame, 4, 0.0f);
  const FlipKernels k = flip_kernels(kPixelsPerDegree);
  EXPECT_EQ(largest(flip_map(a, a, k)), 0);
  EXPECT_EQ(flip_map(a, b, k).values, flip_map(b, a, k).values);
  EXPECT_LE(largest(flip_map(a, b, k)), 1);
}

double flip_of_constants(const Vec& x, const Vec& r) {
  const Region frame{0, 0, 12, 10};
  const auto image = [&](const Vec& v) { return constant(frame, float(v[0]), float(v[1]), float(v[2])); };
  const ErrorMap map = flip_map(image(x), image(r), flip_kernels(kPixelsPerDegree));
  EXPECT_NEAR(largest(map), mean(map), 1e-5);
  return mean(map);
}

// Constant colours pass all kernels unchanged and have no features: FLIP is the distance of the colours.
TEST(Flip, OfConstantColoursIsTheirDistance) {
  const Vec black{0, 0, 0}, white{1, 1, 1}, green{0, 1, 0}, blue{0, 0, 1}, grey{0.2, 0.2, 0.2};
  // |dL| = 100. Green: L 87.74, a -86.18, b 83.18; blue: L 32.30, a 79.19, b -107.86, each of a, b times L /
  // 100: the largest distance is 55.44 + |(-101.19, 107.82)| = 203.31, to the power of 0.7 it is 41.28.
  const double largest = std::pow(203.31, 0.7), knee = 0.4 * largest;
  EXPECT_NEAR(flip_of_constants(black, white), 0.95 + 0.05 * (std::pow(100, 0.7) - knee) / (largest - knee),
              1e-4);
  EXPECT_NEAR(flip_of_constants(black, white), 0.9674, 1e-4);
  EXPECT_NEAR(flip_of_constants(green, blue), 1, 1e-5);
  const double lightness = 116 * std::cbrt(0.2) - 16;  // 51.84
  EXPECT_NEAR(flip_of_constants(grey, black), 0.95 * std::pow(lightness, 0.7) / knee, 1e-4);
  EXPECT_NEAR(flip_of_constants({0.9, 0.1, 0.3}, {0.7, 0.2, 0.4}),
              color_error({0.9, 0.1, 0.3}, {0.7, 0.2, 0.4}), 1e-4);
}

// A vertical edge in the middle, only in one image: far away from the edge, in the half that is alike, none.
TEST(Flip, DifferencesReachAsFarAsTheKernels) {
  const Region frame{0, 0, 80, 9};
  const Image r = constant(frame, 0.2f, 0.2f, 0.2f);
  Image x = r;
  for (int c = 0; c < 3; ++c)
    for (int y = 0; y < 9; ++y)
      for (int px = 40; px < 80; ++px) x.at(c, px, y) = 0.6f;
  const Image map = image_of(flip_map(x, r, flip_kernels(kPixelsPerDegree)));
  EXPECT_NEAR(map.at(0, 29, 4), 0, 1e-4f);
  EXPECT_GT(map.at(0, 41, 4), map.at(0, 70, 4)) << "the edge is seen more than the shade";
  EXPECT_NEAR(map.at(0, 70, 4), color_error({0.6, 0.6, 0.6}, {0.2, 0.2, 0.2}), 1e-4);
}

TEST(Flip, NanIsNotHidden) {
  const Region frame{0, 0, 40, 30};
  const Image r = squares(frame, 5, 0.3f);
  Image x = r;
  x.at(0, 30, 20) = std::nanf("");
  EXPECT_TRUE(std::isnan(mean(flip_map(x, r, flip_kernels(kPixelsPerDegree)))));
}

}  // namespace
}  // namespace tessera
