// SPDX-License-Identifier: Apache-2.0
#include "worker/render/sample_sums.h"

#include <cassert>

namespace tessera::tracer {
namespace {

void add_to(Lane& sum, const Lane& term) {
  for (std::size_t i = 0; i < kBlockPixels; ++i) sum[i] += term[i];
}

void add_square_to(Lane& sum, const Lane& term) {
  for (std::size_t i = 0; i < kBlockPixels; ++i) sum[i] += term[i] * term[i];
}

}  // namespace

SampleSums::SampleSums(const FilmLayout& layout) : planes_(static_cast<std::size_t>(layout.planes())) {
  for (int i = 0; i < kAovs; ++i) {
    const auto aov = static_cast<Aov>(i);
    if (!layout.aovs().has(aov)) continue;
    for (int c = 0; c < static_cast<int>(info(aov).channels.size()); ++c)
      terms_.push_back({SampleBlock::channel(aov) + static_cast<std::size_t>(c), layout.sum(aov, c, Half::a),
                        info(aov).squares ? layout.square(aov, c, Half::a) : -1});
  }
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
  const auto plane = [&](int p) -> Lane& { return leaf[static_cast<std::size_t>(p + half)]; };
  add_to(plane(FilmLayout::count(Half::a)), block.valid);
  add_to(plane(FilmLayout::hits(Half::a)), block.hit);
  for (const Term& t : terms_) {
    add_to(plane(t.sum), block.values[t.channel]);
    if (t.square >= 0) add_square_to(plane(t.square), block.values[t.channel]);
  }
  if (++samples_ < kLeafSamples) return;
  samples_ = 0;
  while (leaves_.size() > 1 && leaves_[leaves_.size() - 2] == leaves_.back()) {
    const std::size_t last = leaves_.size() - 1;
    for (std::size_t p = 0; p < planes_; ++p) add_to(level(last - 1)[p], level(last)[p]);
    leaves_.pop_back();
    leaves_.back() *= 2;
    sums_.resize(leaves_.size() * planes_);
  }
}

std::span<const Lane> SampleSums::result() const {
  assert(leaves_.size() == 1 && samples_ == 0);
  return sums_;
}

}  // namespace tessera::tracer
