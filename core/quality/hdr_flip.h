// SPDX-License-Identifier: Apache-2.0
// HDR-FLIP: FLIP at every exposure at which someone might look (Andersson, Nilsson, Shirley, Akenine-Moller
// 2021, "Visualizing Errors in Rendered High Dynamic Range Images").
#pragma once

#include "core/quality/flip.h"

namespace tessera {

struct Exposures {
  double start = 0, stop = 0;  // in stops
  int count = 2;
  double at(int i) const { return start + (stop - start) * i / (count - 1); }
  bool operator==(const Exposures&) const = default;
};

// From the one at which the brightest pixel of the reference is just not burnt out, to that at which its
// median is (tone-mapped 0.85). The median is of the pixels that are not black, and 0 stops are looked at if
// all are. Parts of an image are comparable only at the exposures of the whole.
Exposures flip_exposures(const Image& reference);

// ACES as fitted by Narkowicz 2015, of values without pre-exposure, 0 to 1. NaN stays NaN.
float tone_mapped(float linear);

// Per pixel the largest FLIP of all exposures. Takes linear RGB; what is negative is 0.
ErrorMap hdr_flip_map(const Image& x, const Image& r, const FlipKernels&, const Exposures&);

}  // namespace tessera
