// SPDX-License-Identifier: Apache-2.0
// The guided filter (Bauszat et al. 2011): box sums along rows and columns, a fit in every window, their
// mean.
#include <algorithm>

#include "kernels.h"
#include "worker/denoise/programs.h"

namespace tessera {
namespace {

constexpr int kMoments = 30, kFit = 15, kValues = 8;  // planes: see the kernels
constexpr int kStrip = 96;  // columns of which a window's rows of all planes stay in the cache

template <typename Body>
void each_strip(const Region& region, const Body& body) {
  for (int x = region.x0; x < region.x1; x += kStrip)
    body(Region{x, region.y0, std::min(x + kStrip, region.x1), region.y1});
}

// Sums along rows are needed in the rows of a window beyond those of the fits and of the result.
void run(Stage& s) {
  const int radius = static_cast<int>(s.plan()["radius"]), rows = s.outer().height();
  const Region fits = s.region(1), tall{fits.x0, s.outer().y0, fits.x1, s.outer().y1},
               low{s.inner().x0, fits.y0, s.inner().x1, fits.y1};
  const double scale = s.plan()["depth_scale"];
  const Planes values = s.planes(kValues), fit = s.planes(kFit + 1);
  const Planes sums = s.scratch(static_cast<std::size_t>(s.layout().plane) * kMoments);
  s.run("prepare", s.outer(), 1, s.input(), s.outer().width(), rows, values, s.layout(),
        scale > 0 ? static_cast<float>(1 / scale) : 1.0f);
  s.run("guided_moments", tall, 1, values, sums, s.layout(), Exactly{tall}, radius);
  each_strip(fits, [&](const Region& strip) {
    s.run("guided_fit", strip, 1, values, sums, fit, s.layout(), Exactly{strip}, rows, radius,
          static_cast<float>(s.plan()["epsilon"]));
  });
  s.run("guided_rows", low, 1, fit, sums, s.layout(), Exactly{low}, radius);
  each_strip(s.inner(), [&](const Region& strip) {
    s.run("guided_apply", strip, 1, s.input(), s.outer().width(), rows, values, sums, fit, s.layout(),
          Exactly{strip}, Exactly{s.inner()}, radius, s.output());
  });
}

}  // namespace

Program guided_program() {
  return {"guided", {kernels::guided_cl}, [](const FilterPlan&) { return std::string(); }, run};
}

}  // namespace tessera
