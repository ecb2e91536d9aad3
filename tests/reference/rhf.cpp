// SPDX-License-Identifier: Apache-2.0
#include "tests/reference/rhf.h"

#include <cmath>

#include "tests/reference/rhf_scales.h"

namespace tessera::reference {
namespace {

struct Offset {
  int x, y;
};

std::vector<Offset> square(int radius) {
  std::vector<Offset> all;
  for (int j = -radius; j <= radius; ++j)
    for (int i = -radius; i <= radius; ++i) all.push_back({i, j});
  return all;
}

// The pixels of one scale, with what decides whether they are alike.
class Pixels {
 public:
  Pixels(const FilterPlan& plan, const RhfPicture& scale) : plan_(plan), f_(scale) {}

  // It is a neighbour of others.
  bool counts(int x, int y) const { return f_.counts(x, y); }

  // For every pixel those of its window that agree with it, itself among them; none if it does not count.
  std::vector<std::vector<Offset>> alike() const {
    const Region& r = f_.region;
    std::vector<std::vector<Offset>> all(static_cast<std::size_t>(r.area()));
    for (const Offset& o : square(static_cast<int>(plan_["radius"]))) {
      const std::vector<Distance> distances = distances_to(o);
      for (int y = r.y0; y < r.y1; ++y)
        for (int x = r.x0; x < r.x1; ++x)
          if (counts(x, y) && ((o.x == 0 && o.y == 0) || agree(x, y, o, distances)))
            all[f_.index(x, y)].push_back(o);
    }
    return all;
  }

 private:
  struct Distance {
    double sum = 0;
    int bins = 0;
  };

  // Whether the patches about both pixels are alike, and their guides if they are asked.
  bool agree(int x, int y, const Offset& o, const std::vector<Distance>& distances) const {
    if (!counts(x + o.x, y + o.y) || !gate_open(x, y, x + o.x, y + o.y)) return false;
    Distance all;
    for (const Offset& k : square(static_cast<int>(plan_["patch"]))) {
      if (!f_.region.contains(x + k.x, y + k.y)) continue;
      const Distance& d = distances[f_.index(x + k.x, y + k.y)];
      all.sum += d.sum;
      all.bins += d.bins;
    }
    return all.bins > 0 && all.sum / all.bins < plan_["threshold"];
  }

  // Of each pixel to the one `o` further.
  std::vector<Distance> distances_to(const Offset& o) const {
    const Region& r = f_.region;
    std::vector<Distance> all;
    for (int y = r.y0; y < r.y1; ++y)
      for (int x = r.x0; x < r.x1; ++x) all.push_back(distance(x, y, x + o.x, y + o.y));
    return all;
  }

  Distance distance(int px, int py, int qx, int qy) const {
    Distance d;
    if (!counts(px, py) || !counts(qx, qy)) return d;
    const RhfPixel &p = f_.at(px, py), &q = f_.at(qx, qy);
    const double np = p.samples, nq = q.samples;
    const double a = std::sqrt(nq / np), b = std::sqrt(np / nq);
    // Of whole counts, more than one sample.
    const double least = plan_.is("bins", "shared") ? 1.000001 : 0;
    for (int k = 0; k < RhfPixel::bins; ++k) {
      const double hp = p.counts[k], hq = q.counts[k];
      if (hp + hq <= least) continue;
      d.sum += (a * hp - b * hq) * (a * hp - b * hq) / (hp + hq);
      ++d.bins;
    }
    return d;
  }

  bool gate_open(int px, int py, int qx, int qy) const {
    const double gate = plan_["gate"];
    if (gate == 0) return true;
    for (int c = 0; c < 3; ++c) {
      const double albedo = f_.at(px, py).albedo[c] - f_.at(qx, qy).albedo[c];
      const double normal = (f_.at(px, py).normal[c] - f_.at(qx, qy).normal[c]) / 2;
      if (std::abs(albedo) > 0.03 * gate || std::abs(normal) > 0.06 * gate) return false;
    }
    return true;
  }

  const FilterPlan& plan_;
  const RhfPicture& f_;
};

// Each pixel's mean of its likes.
std::vector<Rgb> filtered(const FilterPlan& plan, const RhfPicture& scale) {
  const Pixels pixels(plan, scale);
  const Region& r = scale.region;
  const auto found = pixels.alike();
  // The patches that cover a pixel; of pixels, the one.
  const auto covering = square(plan.is("average", "patches") ? static_cast<int>(plan["patch"]) : 0);
  std::vector<Rgb> out;
  for (int y = r.y0; y < r.y1; ++y)
    for (int x = r.x0; x < r.x1; ++x) {
      double sum = 0;
      Rgb total{};
      for (const Offset& o : covering) {
        if (!scale.at(x, y).valid || !pixels.counts(x - o.x, y - o.y)) continue;
        const auto& patches = found[scale.index(x - o.x, y - o.y)];
        for (const Offset& q : patches) {
          if (!pixels.counts(x + q.x, y + q.y)) continue;
          const double w = 1.0 / static_cast<double>(patches.size());
          sum += w;
          for (int c = 0; c < 3; ++c) total[c] += w * scale.at(x + q.x, y + q.y).color[c];
        }
      }
      out.push_back(scale.at(x, y).color);
      for (int c = 0; sum > 0 && c < 3; ++c) out.back()[c] = total[c] / sum;
    }
  return out;
}

}  // namespace

Image rhf(const FilterPlan& plan, const Image& input) {
  const RhfPicture finest = finest_scale(plan, input);
  std::vector<RhfPicture> scales{finest};
  while (scales.size() < plan["scales"])
    scales.push_back(coarser_scale(finest, static_cast<int>(scales.size())));
  std::vector<Rgb> merged = filtered(plan, scales.back());
  for (std::size_t s = scales.size() - 1; s-- > 0;)
    merged = merged_into(scales[s], filtered(plan, scales[s]), scales[s + 1], merged);
  Image out(input.region(), 3);
  for (std::size_t i = 0; i < merged.size(); ++i)
    for (int c = 0; c < 3; ++c)
      out.plane(c)[i] = static_cast<float>(std::isfinite(merged[i][c]) ? merged[i][c] : 0);
  return out;
}

}  // namespace tessera::reference
