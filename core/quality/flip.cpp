// SPDX-License-Identifier: Apache-2.0
// Sections and equations are those of the paper. Opponent colours are kept without the factors and offsets of
// YCxCz (Y = 116 y - 16, Cx = 500 (x - y), Cz = 200 (y - z)): kernels of sum 1 let them pass unchanged, and
// the features take (Y + 16) / 116 = y.
#include "core/quality/flip.h"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <numeric>

#include "core/quality/color_space.h"
#include "core/quality/separable.h"

namespace tessera {
namespace {

using Plane = std::vector<float>;
constexpr Matrix3 kXyz = xyz_of_rgb(), kRgb = rgb_of_xyz();

// Table 1: a sqrt(pi / b) exp(-pi^2 d^2 / b), d in degrees.
struct Sensitivity {
  double a, b;
  double sigma(double ppd) const { return std::sqrt(b / 2) / std::numbers::pi * ppd; }
};
constexpr Sensitivity kAchromatic{1, 0.0047}, kRedGreen{1, 0.0053};
constexpr Sensitivity kBlueYellow[2] = {{34.1, 0.04}, {13.5, 0.025}};

double sum_of(const std::vector<double>& values) {
  return std::accumulate(values.begin(), values.end(), 0.0);
}

// Section 4.1.2: three standard deviations of the widest.
int sensitivity_radius(double ppd) { return static_cast<int>(std::ceil(3 * kBlueYellow[0].sigma(ppd))); }

// Energy of one of the two Gaussians in the plane.
double weight_of(const Sensitivity& s, double ppd, int radius) {
  const double line = sum_of(bell(s.sigma(ppd), radius));
  return s.a * std::sqrt(std::numbers::pi / s.b) * line * line;
}

void normalise_lobes(std::vector<double>& kernel) {
  double positive = 0, negative = 0;
  for (const double v : kernel) (v > 0 ? positive : negative) += v;
  for (double& v : kernel) v /= v > 0 ? positive : -negative;
}

struct Opponent {
  Plane y, x_y, y_z;  // y, x - y, y - z
};

Opponent opponent_of(const Image& rgb) {
  const std::size_t n = rgb.plane(0).size();
  Opponent o{Plane(n), Plane(n), Plane(n)};
  const auto r = rgb.plane(0), g = rgb.plane(1), b = rgb.plane(2);
  const auto clipped = [](float v) { return std::clamp(v, 0.0f, 1.0f); };
  for (std::size_t i = 0; i < n; ++i) {
    const Triple xyz = kXyz * Triple{clipped(r[i]), clipped(g[i]), clipped(b[i])};
    o.y[i] = xyz[1], o.x_y[i] = xyz[0] - xyz[1], o.y_z[i] = xyz[1] - xyz[2];
  }
  return o;
}

Plane filtered(const Plane& in, Size size, const std::vector<double>& across,
               const std::vector<double>& down) {
  return along_columns<float>(along_rows<float>(in, size, across), size, down);
}

// Section 4.1: what the eye resolves of the colours, back inside the gamut, in L*a*b* whose chroma grows with
// lightness (Hunt).
struct Seen {
  Plane l, a, b;
};

Seen seen_by_eye(const Opponent& in, Size size, const FlipKernels& k) {
  Seen s{filtered(in.y, size, k.achromatic, k.achromatic), filtered(in.x_y, size, k.red_green, k.red_green),
         filtered(in.y_z, size, k.blue_yellow[0], k.blue_yellow[0])};
  const Plane narrow = filtered(in.y_z, size, k.blue_yellow[1], k.blue_yellow[1]);
  const float share = static_cast<float>(k.blue_yellow_share);
  for (std::size_t i = 0; i < s.l.size(); ++i) {
    const float y = s.l[i], y_z = narrow[i] + share * (s.b[i] - narrow[i]);
    Triple rgb = kRgb * Triple{y + s.a[i], y, y - y_z};
    for (float& v : rgb) v = std::clamp(v, 0.0f, 1.0f);
    const Triple c = lab(kXyz * rgb);
    s.l[i] = c[0], s.a[i] = 0.01f * c[0] * c[1], s.b[i] = 0.01f * c[0] * c[2];
  }
  return s;
}

// Section 4.2: how strong edges and points are, of `kind` edge or point.
Plane strength(const Plane& y, Size size, const FlipKernels& k, const std::vector<double>& kind,
               const Plane& smooth_rows) {
  const Plane across = along_columns<float>(along_rows<float>(y, size, kind), size, k.smooth);
  Plane down = along_columns<float>(smooth_rows, size, kind);
  for (std::size_t i = 0; i < down.size(); ++i)
    down[i] = std::sqrt(across[i] * across[i] + down[i] * down[i]);
  return down;
}

struct Appearance {
  Seen color;
  Plane edge, point;
};

Appearance appearance_of(const Image& image, const FlipKernels& k) {
  const Size size{image.region().width(), image.region().height()};
  const Opponent o = opponent_of(image);
  const Plane smooth_rows = along_rows<float>(o.y, size, k.smooth);
  return {seen_by_eye(o, size, k), strength(o.y, size, k, k.edge, smooth_rows),
          strength(o.y, size, k, k.point, smooth_rows)};
}

// Section 4.1.4: HyAB to the power of 0.7; the distance of green from blue is the largest there is.
float color_distance(float dl, float da, float db) {
  return std::pow(std::abs(dl) + std::sqrt(da * da + db * db), 0.7f);
}

float largest_distance() {
  const auto hunt = [](const Triple& rgb) {
    const Triple c = lab(kXyz * rgb);
    return Triple{c[0], 0.01f * c[0] * c[1], 0.01f * c[0] * c[2]};
  };
  const Triple green = hunt({0, 1, 0}), blue = hunt({0, 0, 1});
  return color_distance(green[0] - blue[0], green[1] - blue[1], green[2] - blue[2]);
}

// The distances up to 0.4 of the largest take 0.95 of the range.
float redistributed(float distance, float most) {
  const float knee = 0.4f * most;
  return distance < knee ? 0.95f * distance / knee : 0.95f + 0.05f * (distance - knee) / (most - knee);
}

}  // namespace

FlipKernels flip_kernels(double ppd) {
  assert(ppd > 0);
  FlipKernels k;
  const int radius = sensitivity_radius(ppd);
  k.achromatic = gaussian(kAchromatic.sigma(ppd), radius);
  k.red_green = gaussian(kRedGreen.sigma(ppd), radius);
  double weight[2];
  for (int i = 0; i < 2; ++i) {
    k.blue_yellow[i] = gaussian(kBlueYellow[i].sigma(ppd), radius);
    weight[i] = weight_of(kBlueYellow[i], ppd, radius);
  }
  k.blue_yellow_share = weight[0] / (weight[0] + weight[1]);

  const double sigma = 0.5 * 0.082 * ppd;  // section 4.2.1
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  k.smooth = gaussian(sigma, reach);
  k.edge = k.point = k.smooth;
  for (int i = -reach; i <= reach; ++i) {
    k.edge[static_cast<std::size_t>(i + reach)] *= -i;
    k.point[static_cast<std::size_t>(i + reach)] *= i * i / (sigma * sigma) - 1;
  }
  normalise_lobes(k.edge);
  normalise_lobes(k.point);
  return k;
}

ErrorMap flip_map(const Image& x, const Image& r, const FlipKernels& kernels) {
  assert(x.region() == r.region() && !x.region().empty() && x.planes() >= 3 && r.planes() >= 3);
  const Appearance a = appearance_of(x, kernels), b = appearance_of(r, kernels);
  const float most = largest_distance();
  ErrorMap map{x.region(), std::vector<double>(a.edge.size())};
  for (std::size_t i = 0; i < map.values.size(); ++i) {
    const float color = redistributed(
        color_distance(a.color.l[i] - b.color.l[i], a.color.a[i] - b.color.a[i], a.color.b[i] - b.color.b[i]),
        most);
    const float feature = std::max(std::abs(a.edge[i] - b.edge[i]), std::abs(a.point[i] - b.point[i])) /
                          std::numbers::sqrt2_v<float>;
    map.values[i] = std::pow(color, 1 - std::sqrt(feature));
  }
  return map;
}

}  // namespace tessera
