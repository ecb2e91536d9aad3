// SPDX-License-Identifier: Apache-2.0
// Everything rendered so far of one frame, as sums; and the blocks of sums that tasks deliver.
#pragma once

#include <map>
#include <span>
#include <vector>

#include "core/aov.h"
#include "core/image.h"
#include "core/sample_range.h"

namespace tessera {

// What a render task returns: sums over one dyadic range of samples, planes laid out by FilmLayout.
struct Block {
  SampleRange samples;
  Image sums;
};

// a's range must be directly followed by b's, its sibling. Adds b to a; a then spans both. Their planes are
// those of `layout`.
void join(Block& a, const Block& b, const FilmLayout& layout);

// The halves of a pixel, or both together.
enum class Part : std::uint8_t { a, b, all };

// The statistics of `part` of the film sums `sums` (laid out by `layout`), one plane per channel asked for.
// A pixel without valid samples is 0 in every channel, and kSkyDepth deep. Planes of single samples come as
// they are, for the one of both halves that is asked for; ranks do not come at all, but from matte().
Image developed(const Image& sums, const FilmLayout& layout, std::span<const Channel> channels, Part part);

// The Cryptomatte ranks of both halves together: id, coverage (0..1), id, coverage, ...; 2 * kMatteRanks
// planes.
Image matte(const Image& sums, const FilmLayout& layout, Aov);

// Sums of one frame. Folding is exactly-once by construction: a block that is already in is refused.
class Film {
 public:
  Film(const Region& frame, AovSet aovs);
  // Goes on with the sums of a film that was settled. `samples`: of each pixel, row-major.
  Film(AovSet aovs, Image sums, std::vector<int> samples);

  const Region& region() const { return sums_.region(); }
  const FilmLayout& layout() const { return layout_; }
  const Image& sums() const& { return sums_; }
  Image sums() && { return std::move(sums_); }

  // Takes a block in any order; siblings are joined in index order and enter the sums when they continue what
  // is there. Blocks of overlapping regions must have equal regions. Returns false, and changes nothing, for
  // a block whose samples are in already or pending.
  bool fold(Block block);
  // Some of these samples of the region are in, or wait for a sibling.
  bool has(const Region& region, const SampleRange& samples) const;

  // The pixel's sums hold exactly the samples [0, samples).
  int samples(int x, int y) const { return counts_[index(x, y)]; }
  // True if samples(x, y) == n in all of `region`.
  bool covers(const Region& region, int n) const;
  // Nothing is waiting for a sibling.
  bool settled() const { return pending_.empty(); }

 private:
  std::size_t index(int x, int y) const {
    return static_cast<std::size_t>(y - region().y0) * region().width() + (x - region().x0);
  }
  void add(const Block& block);
  bool continues(const Region& region, const SampleRange& samples) const;

  FilmLayout layout_;
  Image sums_;
  std::vector<int> counts_;  // samples [0, n) of each pixel that are in sums_
  std::map<std::pair<Region, SampleRange>, Block> pending_;
};

}  // namespace tessera
