// SPDX-License-Identifier: Apache-2.0
// Reasons to distrust a small error estimate: signs, in the film's sums, that the energy which decides the
// picture has hardly been seen yet. The estimates are unbiased whatever was seen, but their standard errors
// are too small while rare, bright samples are missing. Pure. All guards lift by themselves as samples grow,
// on any picture whose samples have a finite variance.
#pragma once

#include <string_view>

#include "core/film.h"

namespace tessera {

// Why a cell must not stop yet although its error looks small.
enum class Guard : unsigned char {
  none,
  concentrated_energy,  // most energy in few pixels, and the halves disagree about which
  heavy_tails,          // kurtosis of the halves' normalised difference
  single_sample,        // one sample could move the cell's mean by more than the target
  too_dark,             // too few samples that carried light
};
std::string_view to_string(Guard);

// The first guard that holds for the pixels of `cell`, in the order above. `sums` are film sums laid out by
// `layout`, which holds Aov::color, and cover `cell`; `target` is the relMSE aimed at. What each sees, and
// what it misses, is said in guards.cpp. Matters only where the error's bound is below the target.
Guard guard_of(const Image& sums, const FilmLayout& layout, const Region& cell, double target);

}  // namespace tessera
