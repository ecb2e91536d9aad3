// SPDX-License-Identifier: Apache-2.0
// What a filter takes, gathered from files that some renderer has written.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "core/exr.h"
#include "core/filter/filter.h"

namespace tessera {

struct Sources {
  const ExrImage* picture = nullptr;  // of which the region is filtered
  std::map<std::string, ExrImage>
      separate;  // by layer ("albedo", "N", "Z", ...): files of that layer alone, or among others
  std::optional<double> samples;  // per pixel, where no file says how many
};

struct Gathered {
  Image input;                       // plan.inputs() over the picture's data window
  std::vector<std::string> notices;  // what was not there, and what stands in for it
};

// Depth of 1e10 and more (the sky of Cycles), or that is not finite, becomes kSkyDepth. What can be found in
// no file: variances of light are estimated from the picture; other variances count as 0; halves are the
// whole; emission is none; direct and indirect light are filtered as one. All of that is said in the notices.
// Throws InputError that names the layer for anything else, and for files of another size.
Gathered gather(const FilterPlan&, const Sources&, const std::string& name_of_picture);

// The variance of each pixel's noise, from the picture alone: the squared response of the 3x3 difference of
// two Laplacians (which is blind to planes; J. Immerkaer: Fast Noise Variance Estimation, CVIU 1996),
// averaged over 7x7. Detail counts as noise. One plane for each of `picture`.
Image estimated_variance(const Image& picture);

// The scene's facts as far as a frame tells them: the diagonal of what P holds, else the largest depth.
SceneFacts facts_of(const FilterPlan&, const Image& input, const Sources&);

}  // namespace tessera
