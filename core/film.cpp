// SPDX-License-Identifier: Apache-2.0
#include "core/film.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <optional>
#include <vector>

#include "core/ranks.h"

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

// The mean cube of the distances from the mean, by the moments about 0.
void third_moment(Plane sum, Plane square, Plane cube, Plane count, std::span<float> to) {
  for (std::size_t i = 0; i < to.size(); ++i) {
    const double n = count[i];
    const double m = sum[i] / n, m2 = square[i] / n, m3 = cube[i] / n;
    to[i] = n > 0 ? static_cast<float>(m3 - 3 * m * m2 + 2 * m * m * m) : 0.0f;
  }
}

// Adds `part`, an image of planes laid out as those of `to`, where it lies. Lists of ranks are merged.
void add(const Image& part, Image& to, const FilmLayout& layout) {
  const Region& r = part.region();
  const auto offset = static_cast<std::size_t>(r.x0 - to.region().x0);
  std::vector<bool> ranked(static_cast<std::size_t>(to.planes()));
  for (const int list : layout.rank_lists()) {
    for (int k = 0; k < 2 * kMatteRanks; ++k) ranked[static_cast<std::size_t>(list + 2 * k)] = true;
    const std::size_t stride = 2 * part.plane(0).size(), stride_to = 2 * to.plane(0).size();
    for (int y = r.y0; y < r.y1; ++y) {
      const float* from = part.row(list, y).data();
      float* at = to.row(list, y).data() + offset;
      for (int x = 0; x < r.width(); ++x)
        store_ranks(merged(load_ranks(at + x, stride_to), load_ranks(from + x, stride)), at + x, stride_to);
    }
  }
  for (int p = 0; p < to.planes(); ++p) {
    if (ranked[static_cast<std::size_t>(p)]) continue;
    for (int y = r.y0; y < r.y1; ++y) {
      const auto from = part.row(p, y);
      const auto at = to.row(p, y).subspan(offset, static_cast<std::size_t>(r.width()));
      for (std::size_t x = 0; x < at.size(); ++x) at[x] += from[x];
    }
  }
}

}  // namespace

void join(Block& a, const Block& b, const FilmLayout& layout) {
  assert(are_siblings(a.samples, b.samples) && a.sums.region() == b.sums.region());
  add(b.sums, a.sums, layout);
  a.samples.end = b.samples.end;
}

namespace {

// The part that a channel speaks of when `part` is developed.
Part part_of(Share share, Part part) {
  if (share == Share::all || part != Part::all) return part;
  return share == Share::a ? Part::a : Part::b;
}

// Develops channels of one film, keeping the sums it works on.
class Developer {
 public:
  Developer(const Image& sums, const FilmLayout& layout) : sums_(sums), layout_(layout) {
    for (Floats* v : {&count_, &hits_, &sum_, &square_, &cube_})
      v->resize(static_cast<std::size_t>(sums.region().area()));
  }

  void develop(const Channel& c, Part part, std::span<float> to) {
    const Reduction reduction = info(c.aov).reduction;
    assert(reduction != Reduction::ranks && (reduction != Reduction::per_sample || part != Part::all));
    count(part);
    if (c.statistic == Statistic::samples) {
      std::ranges::copy(count_, to.begin());
    } else if (reduction == Reduction::point) {
      take(sums_, layout_.sum(c.aov, c.index, Half::a), Part::all, to);
    } else if (reduction == Reduction::per_sample) {
      power(c, 1, part, sum_);
      std::ranges::copy(sum_, to.begin());
    } else {
      statistic(c, part, to);
    }
  }

 private:
  void count(Part part) {
    if (counted_ == part) return;
    take(sums_, FilmLayout::count(Half::a), part, count_);
    take(sums_, FilmLayout::hits(Half::a), part, hits_);
    counted_ = part;
  }
  void power(const Channel& c, int n, Part part, Floats& to) {
    take(sums_, layout_.sum(c.aov, c.index, Half::a, n), part, to);
  }
  void statistic(const Channel& c, Part part, std::span<float> to) {
    const Plane n = c.aov == Aov::depth ? hits_ : count_;
    power(c, 1, part, sum_);
    if (c.statistic != Statistic::mean) power(c, 2, part, square_);
    if (c.statistic == Statistic::variance_of_mean) {
      variance_of_mean(sum_, square_, n, to);
    } else if (c.statistic == Statistic::third_moment) {
      power(c, 3, part, cube_);
      third_moment(sum_, square_, cube_, n, to);
    } else {
      mean(sum_, n, c.aov == Aov::depth ? kSkyDepth : 0.0f, to);
    }
  }

  const Image& sums_;
  const FilmLayout& layout_;
  std::optional<Part> counted_;  // what count_ and hits_ hold
  Floats count_, hits_, sum_, square_, cube_;
};

}  // namespace

Image developed(const Image& sums, const FilmLayout& layout, std::span<const Channel> channels, Part part) {
  Image out = Image::unset(sums.region(), static_cast<int>(channels.size()));
  Developer developer(sums, layout);
  for (std::size_t k = 0; k < channels.size(); ++k)
    developer.develop(channels[k], part_of(channels[k].share, part), out.plane(static_cast<int>(k)));
  return out;
}

Image matte(const Image& sums, const FilmLayout& layout, Aov aov) {
  Image out = Image::unset(sums.region(), 2 * kMatteRanks);
  const std::size_t area = sums.plane(0).size();
  for (std::size_t i = 0; i < area; ++i) {
    const auto list = [&](Half h) {
      return load_ranks(sums.plane(layout.sum(aov, 0, h)).data() + i, 2 * area);
    };
    RankList all = merged(list(Half::a), list(Half::b));
    const float n = sums.plane(FilmLayout::count(Half::a))[i] + sums.plane(FilmLayout::count(Half::b))[i];
    for (Rank& r : all) r.samples = n > 0 ? r.samples / n : 0;
    store_ranks(all, out.plane(0).data() + i, area);
  }
  return out;
}

Film::Film(const Region& frame, AovSet aovs)
    : layout_(aovs), sums_(frame, layout_.planes()), counts_(static_cast<std::size_t>(frame.area())) {}

Film::Film(AovSet aovs, Image sums, std::vector<int> samples)
    : layout_(aovs), sums_(std::move(sums)), counts_(std::move(samples)) {
  assert(sums_.planes() == layout_.planes() && std::ssize(counts_) == region().area());
}

// The next block of a pixel at n samples is [0, m) if n is 0, else [n, 2n): the tree's spine.
bool Film::continues(const Region& region, const SampleRange& range) const {
  const int n = samples(region.x0, region.y0);
  return range.begin == n && (n == 0 || range.count() == n);
}

bool Film::has(const Region& area, const SampleRange& range) const {
  if (range.begin < samples(area.x0, area.y0)) return true;
  for (auto it = pending_.lower_bound({area, {}}); it != pending_.end() && it->first.first == area; ++it) {
    const SampleRange& waits = it->first.second;
    if (waits.begin < range.end && range.begin < waits.end) return true;
  }
  return false;
}

bool Film::fold(Block block) {
  const Region area = block.sums.region();
  assert(region().contains(area) && !area.empty() && is_dyadic(block.samples));
  if (has(area, block.samples)) return false;
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
    join(partner, block, layout_);
    block = std::move(partner);
  }
  const std::pair key{area, block.samples};
  pending_.emplace(key, std::move(block));
  return true;
}

void Film::add(const Block& block) {
  const Region& r = block.sums.region();
  tessera::add(block.sums, sums_, layout_);
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
