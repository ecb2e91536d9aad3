// SPDX-License-Identifier: Apache-2.0
#include "core/film.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <vector>

namespace tessera {
namespace {

using Plane = std::span<const float>;

// Part of a pair of planes (half A, half B).
void take(const Image& sums, int plane, Part part, std::span<float> to) {
  const Plane a = sums.plane(plane), b = sums.plane(plane + 1);
  if (part == Part::all)
    std::ranges::transform(a, b, to.begin(), std::plus<>());
  else
    std::ranges::copy(part == Part::a ? a : b, to.begin());
}

void mean(Plane sum, Plane n, float without, std::span<float> to) {
  for (std::size_t i = 0; i < to.size(); ++i) to[i] = n[i] > 0 ? sum[i] / n[i] : without;
}

void variance_of_mean(Plane sum, Plane square, Plane count, std::span<float> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double n = count[i];
    const double m2 = std::max(0.0, double(square[i]) - double(sum[i]) * sum[i] / n);
    to[i] = n < 2 ? 0.0f : static_cast<float>(m2 / ((n - 1) * n));
  }
}

}  // namespace

void join(Block& a, const Block& b) {
  assert(are_siblings(a.samples, b.samples) && a.sums.region() == b.sums.region());
  const auto from = b.sums.data();
  const auto to = a.sums.data();
  for (std::size_t i = 0; i < to.size(); ++i) to[i] += from[i];
  a.samples.end = b.samples.end;
}

Image developed(const Image& sums, const FilmLayout& layout, std::span<const Channel> channels, Part part) {
  Image out(sums.region(), static_cast<int>(channels.size()));
  const auto scratch = [&] { return std::vector<float>(static_cast<std::size_t>(sums.region().area())); };
  std::vector<float> count = scratch(), hits = scratch(), sum = scratch(), square = scratch();
  take(sums, FilmLayout::count(Half::a), part, count);
  take(sums, FilmLayout::hits(Half::a), part, hits);
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const Channel& c = channels[k];
    const auto to = out.plane(static_cast<int>(k));
    take(sums, layout.sum(c.aov, c.index, Half::a), part, sum);
    if (c.statistic == Statistic::variance_of_mean) {
      take(sums, layout.square(c.aov, c.index, Half::a), part, square);
      variance_of_mean(sum, square, count, to);
    } else if (c.aov == Aov::depth) {
      mean(sum, hits, kSkyDepth, to);
    } else {
      mean(sum, count, 0.0f, to);
    }
  }
  return out;
}

Film::Film(const Region& frame, AovSet aovs)
    : layout_(aovs), sums_(frame, layout_.planes()), counts_(static_cast<std::size_t>(frame.area())) {}

// The next block of a pixel at n samples is [0, m) if n is 0, else [n, 2n): the tree's spine.
bool Film::continues(const Region& region, const SampleRange& range) const {
  const int n = samples(region.x0, region.y0);
  return range.begin == n && (n == 0 || range.count() == n);
}

bool Film::fold(Block block) {
  const Region area = block.sums.region();
  assert(region().contains(area) && !area.empty() && is_dyadic(block.samples));
  if (block.samples.begin < samples(area.x0, area.y0)) return false;
  const auto first = pending_.lower_bound({area, {}});
  for (auto it = first; it != pending_.end() && it->first.first == area; ++it) {
    const SampleRange& r = it->first.second;
    if (r.begin < block.samples.end && block.samples.begin < r.end) return false;
  }
  for (;;) {
    if (continues(area, block.samples)) {
      add(block);
      const int n = block.samples.end;
      const auto next = pending_.find({area, {n, 2 * n}});
      if (next == pending_.end()) return true;
      block = std::move(next->second);
      pending_.erase(next);
      continue;
    }
    const auto other = pending_.find({area, sibling(block.samples)});
    if (other == pending_.end()) break;
    Block partner = std::move(other->second);
    pending_.erase(other);
    if (partner.samples.begin > block.samples.begin) std::swap(partner, block);
    join(partner, block);
    block = std::move(partner);
  }
  const std::pair key{area, block.samples};
  pending_.emplace(key, std::move(block));
  return true;
}

void Film::add(const Block& block) {
  const Region& r = block.sums.region();
  for (int p = 0; p < sums_.planes(); ++p)
    for (int y = r.y0; y < r.y1; ++y) {
      const auto from = block.sums.row(p, y);
      const auto to = sums_.row(p, y).subspan(r.x0 - region().x0, r.width());
      for (int x = 0; x < r.width(); ++x) to[x] += from[x];
    }
  for (int y = r.y0; y < r.y1; ++y)
    std::fill_n(counts_.begin() + index(r.x0, y), r.width(), block.samples.end);
}

bool Film::covers(const Region& region, int n) const {
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x)
      if (samples(x, y) != n) return false;
  return true;
}

}  // namespace tessera
