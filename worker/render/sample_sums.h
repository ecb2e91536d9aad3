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

struct alignas(64) Lane : std::array<float, kBlockPixels> {};

// One sample of each pixel of a block: the channels of the AOVs in a set. A histogram is its three bins; a
// matte is one id.
class SampleBlock {
 public:
  explicit SampleBlock(AovSet aovs);

  Lane valid;  // 1 or 0; a sample that is not valid has zeros everywhere
  Lane hit;    // 1: the camera ray hit something

  bool has(Aov a) const { return first_[static_cast<std::size_t>(a)] >= 0; }
  // Channel c of an AOV in the set.
  Lane& channel(Aov a, int c = 0) {
    return values_[static_cast<std::size_t>(first_[static_cast<std::size_t>(a)] + c)];
  }
  const Lane& channel(Aov a, int c = 0) const {
    return values_[static_cast<std::size_t>(first_[static_cast<std::size_t>(a)] + c)];
  }
  // Does nothing for an AOV that is not in the set.
  void set(Aov a, int lane, const Vec3& v) {
    if (!has(a)) return;
    for (int c = 0; c < 3; ++c) channel(a, c)[static_cast<std::size_t>(lane)] = v[c];
  }
  void set(Aov a, int lane, const Vec2& v) {
    if (!has(a)) return;
    for (int c = 0; c < 2; ++c) channel(a, c)[static_cast<std::size_t>(lane)] = v[c];
  }
  void set(Aov a, int lane, float v) {
    if (has(a)) channel(a)[static_cast<std::size_t>(lane)] = v;
  }
  // Makes the sample of a lane one that is not there.
  void drop(std::size_t lane);
  void clear();

 private:
  std::array<int, kAovs> first_;
  std::vector<Lane> values_;
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
    Aov aov;
    int channel;
    int moments;
    std::array<int, 3> plane;  // of each power's sum
  };
  std::span<Lane> level(std::size_t i) { return std::span(sums_).subspan(i * planes_, planes_); }
  void add_terms(std::span<Lane> leaf, int half, const SampleBlock& block) const;
  void add_histogram(std::span<Lane> leaf, int half, const SampleBlock& block) const;
  void add_matte(std::span<Lane> leaf, int half, Aov, const SampleBlock& block) const;
  void add_vectors(std::span<Lane> leaf, int sample, const SampleBlock& block) const;
  void join_last_two();

  FilmLayout layout_;
  std::vector<Term> terms_;   // planes are those of half A; half B's follow
  std::vector<bool> ranked_;  // by plane
  std::size_t planes_;
  std::vector<Lane> sums_;   // a stack of finished subtrees, the last one growing
  std::vector<int> leaves_;  // how many leaves each holds
  int samples_ = 0;          // in the growing leaf
};

}  // namespace tessera::tracer
