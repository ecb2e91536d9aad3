// SPDX-License-Identifier: Apache-2.0
// Ranges of sample indices, and the binary tree in which samples are summed.
//
// A sum over samples has one shape, however the work was split: leaves of kLeafSamples added in order, above
// them aligned dyadic blocks, [0,8) + [8,16) -> [0,16). Float addition is not associative; the fixed tree is
// what makes one worker and many agree bit for bit.
#pragma once

#include <compare>
#include <vector>

namespace tessera {

inline constexpr int kLeafSamples = 8;
inline constexpr int kMaxSamples = 1 << 24;  // per pixel; sample counts stay exact in a float

// Half-open range [begin, end) of sample indices of every pixel of a region.
struct SampleRange {
  int begin = 0, end = 0;
  int count() const { return end - begin; }
  auto operator<=>(const SampleRange&) const = default;
};

// True if the range is a node of the tree: a power of two of at least kLeafSamples, aligned to its own
// length.
bool is_dyadic(const SampleRange&);

// The other child of the same parent. Precondition: is_dyadic.
SampleRange sibling(const SampleRange&);

// True if `a` is directly followed by its sibling `b`.
bool are_siblings(const SampleRange& a, const SampleRange& b);

// Cuts [begin, end), where end is begin or twice begin (or begin is 0) and both are powers of two times
// kLeafSamples, into equal dyadic blocks of at most `most` samples (at least kLeafSamples).
std::vector<SampleRange> dyadic_blocks(const SampleRange&, int most);

}  // namespace tessera
