// SPDX-License-Identifier: Apache-2.0
#include "worker/render/sample_sums.h"

#include <cassert>

#include "core/ranks.h"

namespace tessera::tracer {
namespace {

// Channels of a single sample.
int sample_channels(Aov a) {
  switch (a) {
    case Aov::histogram:
      return 3;
    case Aov::object_matte:
    case Aov::material_matte:
      return 1;
    case Aov::sample_vectors:
      return SampleVector::size;
    default:
      return info(a).channels;
  }
}

bool is_plain(Aov a) {
  return info(a).reduction != Reduction::ranks && info(a).reduction != Reduction::per_sample &&
         a != Aov::histogram;
}

void add_to(Lane& sum, const Lane& term) {
  for (std::size_t i = 0; i < kBlockPixels; ++i) sum[i] += term[i];
}

void add_square_to(Lane& sum, const Lane& term) {
  for (std::size_t i = 0; i < kBlockPixels; ++i) sum[i] += term[i] * term[i];
}

void add_cube_to(Lane& sum, const Lane& term) {
  for (std::size_t i = 0; i < kBlockPixels; ++i) sum[i] += term[i] * term[i] * term[i];
}

}  // namespace

SampleBlock::SampleBlock(AovSet aovs) {
  first_.fill(-1);
  int next = 0;
  for (int i = 0; i < kAovs; ++i) {
    if (!is_aov(i) || !aovs.has(static_cast<Aov>(i))) continue;
    first_[static_cast<std::size_t>(i)] = next;
    next += sample_channels(static_cast<Aov>(i));
  }
  values_.resize(static_cast<std::size_t>(next));
  clear();
}

void SampleBlock::drop(std::size_t lane) {
  valid[lane] = hit[lane] = 0;
  for (Lane& v : values_) v[lane] = 0;
}

void SampleBlock::clear() {
  valid.fill(0);
  hit.fill(0);
  for (Lane& v : values_) v.fill(0);
}

SampleSums::SampleSums(const FilmLayout& layout)
    : layout_(layout),
      ranked_(static_cast<std::size_t>(layout.planes())),
      planes_(static_cast<std::size_t>(layout.planes())) {
  for (int i = 0; i < kAovs; ++i) {
    const auto aov = static_cast<Aov>(i);
    if (!is_aov(i) || !layout.aovs().has(aov) || !is_plain(aov)) continue;
    for (int c = 0; c < info(aov).channels; ++c) {
      Term t{aov, c, layout.moments(aov), {}};
      for (int m = 0; m < t.moments; ++m)
        t.plane[static_cast<std::size_t>(m)] = layout.sum(aov, c, Half::a, m + 1);
      terms_.push_back(t);
    }
  }
  for (const int list : layout.rank_lists())
    for (int k = 0; k < 2 * kMatteRanks; ++k) ranked_[static_cast<std::size_t>(list + 2 * k)] = true;
}

void SampleSums::clear() {
  sums_.clear();
  leaves_.clear();
  samples_ = 0;
}

void SampleSums::add(int sample, const SampleBlock& block) {
  if (samples_ == 0) {
    leaves_.push_back(1);
    sums_.resize(leaves_.size() * planes_, Lane{});
  }
  const std::span<Lane> leaf = level(leaves_.size() - 1);
  const int half = sample & 1;
  add_to(leaf[static_cast<std::size_t>(FilmLayout::count(Half::a) + half)], block.valid);
  add_to(leaf[static_cast<std::size_t>(FilmLayout::hits(Half::a) + half)], block.hit);
  add_terms(leaf, half, block);
  if (block.has(Aov::histogram)) add_histogram(leaf, half, block);
  for (const Aov matte : {Aov::object_matte, Aov::material_matte})
    if (block.has(matte)) add_matte(leaf, half, matte, block);
  if (block.has(Aov::sample_vectors) && sample < kLeafSamples) add_vectors(leaf, sample, block);
  if (++samples_ < kLeafSamples) return;
  samples_ = 0;
  while (leaves_.size() > 1 && leaves_[leaves_.size() - 2] == leaves_.back()) join_last_two();
}

void SampleSums::add_terms(std::span<Lane> leaf, int half, const SampleBlock& block) const {
  for (const Term& t : terms_) {
    const Lane& value = block.channel(t.aov, t.channel);
    const auto plane = [&](std::size_t power) -> Lane& {
      return leaf[static_cast<std::size_t>(t.plane[power - 1] + half)];
    };
    add_to(plane(1), value);
    if (t.moments >= 2) add_square_to(plane(2), value);
    if (t.moments >= 3) add_cube_to(plane(3), value);
  }
}

void SampleSums::add_histogram(std::span<Lane> leaf, int half, const SampleBlock& block) const {
  for (int c = 0; c < 3; ++c)
    for (std::size_t i = 0; i < kBlockPixels; ++i) {
      const int bin = c * kHistogramBins + static_cast<int>(block.channel(Aov::histogram, c)[i]);
      leaf[static_cast<std::size_t>(layout_.sum(Aov::histogram, bin, Half::a) + half)][i] += block.valid[i];
    }
}

void SampleSums::add_matte(std::span<Lane> leaf, int half, Aov aov, const SampleBlock& block) const {
  for (std::size_t i = 0; i < kBlockPixels; ++i) {
    const float id = block.channel(aov)[i];
    if (id == 0 || block.valid[i] == 0) continue;
    float* at = leaf[static_cast<std::size_t>(layout_.sum(aov, 0, Half::a) + half)].data() + i;
    store_ranks(merged(load_ranks(at, 2 * kBlockPixels), {Rank{id, 1}}), at, 2 * kBlockPixels);
  }
}

void SampleSums::add_vectors(std::span<Lane> leaf, int sample, const SampleBlock& block) const {
  for (int c = 0; c < SampleVector::size; ++c) {
    const int slot = SampleVector::size * (sample / 2) + c;
    add_to(leaf[static_cast<std::size_t>(layout_.sum(Aov::sample_vectors, slot, Half::a) + (sample & 1))],
           block.channel(Aov::sample_vectors, c));
  }
}

void SampleSums::join_last_two() {
  const std::size_t last = leaves_.size() - 1;
  const std::span<Lane> to = level(last - 1), from = level(last);
  for (std::size_t p = 0; p < planes_; ++p)
    if (!ranked_[p]) add_to(to[p], from[p]);
  for (const int list : layout_.rank_lists())
    for (std::size_t i = 0; i < kBlockPixels; ++i) {
      constexpr std::size_t kStride = 2 * kBlockPixels;
      float* at = to[static_cast<std::size_t>(list)].data() + i;
      const float* other = from[static_cast<std::size_t>(list)].data() + i;
      store_ranks(merged(load_ranks(at, kStride), load_ranks(other, kStride)), at, kStride);
    }
  leaves_.pop_back();
  leaves_.back() *= 2;
  sums_.resize(leaves_.size() * planes_);
}

std::span<const Lane> SampleSums::result() const {
  assert(leaves_.size() == 1 && samples_ == 0);
  return sums_;
}

}  // namespace tessera::tracer
