// SPDX-License-Identifier: Apache-2.0
// Distances of patches and non-local means (Rousselle et al. 2012, section 4) of whole pictures.
#pragma once

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "tests/reference/features.h"

namespace tessera::reference {

using Plane = std::vector<double>;

// By what patches are told apart.
struct Guide {
  std::vector<Plane> picture, variance;  // by channel
  double k = 1;                          // damping
  double epsilon = 1e-10;                // of the denominator
  double most = INFINITY;                // distance of two pixels
  int radius = 3;                        // of a patch
};

// d^2 of the values of two pixels, channel c (equation 4 of the paper).
inline double pixel_distance(const Guide& g, std::size_t c, std::size_t p, std::size_t q) {
  const double d = g.picture[c][p] - g.picture[c][q], vp = g.variance[c][p], vq = g.variance[c][q];
  return std::min(g.most, (d * d - (vp + std::min(vp, vq))) / (g.epsilon + g.k * g.k * (vp + vq)));
}

// Two valid pixels, the distance of their patches: the mean over channels and over the `pairs` of valid
// pixels.
struct Neighbours {
  int x, y, i, j;
  std::size_t p, q;
  double distance;
  int pairs;
};

// Every pixel with every one in its window, offset after offset.
inline void each_neighbour(const Features& f, const Guide& g, int window,
                           const std::function<void(const Neighbours&)>& body) {
  const Region& r = f.region();
  const std::size_t area = static_cast<std::size_t>(r.area());
  for (int j = -window; j <= window; ++j)
    for (int i = -window; i <= window; ++i) {
      Plane single(area, NAN);
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
          if (!f.valid(x, y) || !f.valid(x + i, y + j)) continue;
          double& sum = single[f.index(x, y)];
          sum = 0;
          for (std::size_t c = 0; c < g.picture.size(); ++c)
            sum += pixel_distance(g, c, f.index(x, y), f.index(x + i, y + j));
        }
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x) {
          if (!f.valid(x, y) || !f.valid(x + i, y + j)) continue;
          Neighbours n{x, y, i, j, f.index(x, y), f.index(x + i, y + j), 0, 0};
          for (int v = -g.radius; v <= g.radius; ++v)
            for (int u = -g.radius; u <= g.radius; ++u) {
              if (!f.inside(x + u, y + v) || std::isnan(single[f.index(x + u, y + v)])) continue;
              n.distance += single[f.index(x + u, y + v)];
              ++n.pairs;
            }
          n.distance /= n.pairs * static_cast<double>(g.picture.size());
          body(n);
        }
    }
}

// Each plane, averaged over the window with weights e^-max(d, 0).
inline std::vector<Plane> smoothed(const Features& f, const Guide& g, int window,
                                   const std::vector<Plane>& planes) {
  const std::size_t area = static_cast<std::size_t>(f.region().area());
  Plane sum(area);
  std::vector<Plane> total(planes.size(), Plane(area));
  each_neighbour(f, g, window, [&](const Neighbours& n) {
    const double w = std::exp(-std::max(0.0, n.distance));
    sum[n.p] += w;
    for (std::size_t k = 0; k < planes.size(); ++k) total[k][n.p] += w * planes[k][n.q];
  });
  for (Plane& t : total)
    for (std::size_t p = 0; p < area; ++p) t[p] = sum[p] > 0 ? t[p] / sum[p] : 0;
  return total;
}

// A channel of the filter's input, by pixel; 0 at invalid ones.
inline Plane plane_of(const Features& f, Aov aov, int channel, Statistic statistic = Statistic::mean,
                      Share share = Share::all) {
  Plane plane(static_cast<std::size_t>(f.region().area()));
  const Region& r = f.region();
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x)
      if (f.valid(x, y)) plane[f.index(x, y)] = f.at(aov, channel, x, y, statistic, share);
  return plane;
}

}  // namespace tessera::reference
