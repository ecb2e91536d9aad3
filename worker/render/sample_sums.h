// SPDX-License-Identifier: Apache-2.0
// From samples to the sums of a film: for one 4x4 block of pixels, in the shape of the sample tree.
#pragma once

#include <array>
#include <span>
#include <vector>

#include "core/aov.h"
#include "core/sample_range.h"
#include "worker/render/vector_math.h"

namespace tessera::tracer {

inline constexpr int kBlockEdge = 4;
inline constexpr int kBlockPixels = kBlockEdge * kBlockEdge;

using Lane = std::array<float, kBlockPixels>;

// One sample of each pixel of a block, channels of all AOVs in the order of the enumeration.
struct SampleBlock {
  alignas(64) std::array<Lane, 22> values;
  alignas(64) Lane valid;  // 1 or 0; a sample that is not valid has zeros everywhere
  alignas(64) Lane hit;    // 1: the camera ray hit something

  static constexpr std::size_t channel(Aov a) { return 3 * static_cast<std::size_t>(a); }
  void set(Aov a, int lane, const Vec3& v) {
    for (std::size_t c = 0; c < 3; ++c) values[channel(a) + c][static_cast<std::size_t>(lane)] = v[int(c)];
  }
};

// Adds samples in index order: leaves of kLeafSamples, joined like core/film.h's `join`.
class SampleSums {
 public:
  explicit SampleSums(const FilmLayout& layout);

  void clear();
  // Samples come in order from the first of a dyadic range.
  void add(int sample, const SampleBlock& block);
  // One Lane a plane. Precondition: exactly a dyadic range was added.
  std::span<const Lane> result() const;

 private:
  struct Term {
    std::size_t channel;
    int sum;
    int square;  // -1: none
  };
  std::span<Lane> level(std::size_t i) { return std::span(sums_).subspan(i * planes_, planes_); }

  std::vector<Term> terms_;  // planes are those of half A; half B's follow
  std::size_t planes_;
  std::vector<Lane> sums_;   // a stack of finished subtrees, the last one growing
  std::vector<int> leaves_;  // how many leaves each holds
  int samples_ = 0;          // in the growing leaf
};

}  // namespace tessera::tracer
