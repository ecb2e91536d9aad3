// SPDX-License-Identifier: Apache-2.0
// The files that `tessera compare` reads: which image belongs to which reference, and what is in them.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/exr.h"

namespace tessera {

struct FramePair {
  int frame = 0;
  std::filesystem::path image, reference;
};

struct FramePairs {
  std::vector<FramePair> pairs;  // in order, not empty
  bool sequence = false;         // else one image
};

// True for a pattern (see core/sequence.h), unless there is a file of just that name.
bool is_sequence(const std::filesystem::path&);

// The frames to compare: those of `frames` (see parse_frames), or from the first to the last that there is
// of the image. A reference that is no sequence is the reference of all. Throws InputError that names every
// missing frame of both, and Error for frames of an image that is no sequence.
FramePairs frame_pairs(const std::filesystem::path& image, const std::filesystem::path& reference,
                       const std::string& frames);

// The three planes `layer`R, `layer`G, `layer`B, unless one of them is missing.
std::optional<Image> layer_of(const ExrImage&, std::string_view layer);

// R, G and B; throws InputError that names `file` if one of them is missing.
Image rgb_of(const std::filesystem::path& file, const ExrImage&);

// Throws InputError that names both if they do not cover the same pixels.
void require_same_region(const std::filesystem::path& x_file, const Region& x,
                         const std::filesystem::path& r_file, const Region& r);

}  // namespace tessera
