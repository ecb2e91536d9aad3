// SPDX-License-Identifier: Apache-2.0
#include "cli/compare_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// Ascending, each once.
std::vector<int> wanted_frames(const fs::path& image, const std::string& frames) {
  if (!frames.empty()) {
    std::vector<int> chosen = parse_frames(frames);
    std::ranges::sort(chosen);
    return chosen;
  }
  std::vector<int> all;  // from the first to the last, so that a gap is found
  const std::vector<int> there = frames_there(image);
  if (there.empty()) return all;
  for (int f = there.front(); f <= there.back(); ++f) all.push_back(f);
  return all;
}

std::string missing_from(const fs::path& pattern, const std::vector<int>& frames) {
  const std::vector<int> there = frames_there(pattern);
  std::vector<int> missing;
  std::ranges::set_difference(frames, there, std::back_inserter(missing));
  return missing.empty() ? "" : fmt::format("{} of {}", ranges_of(missing), pattern.string());
}

std::string text(const Region& r) {
  return fmt::format("{} x {} pixels at ({}, {})", r.width(), r.height(), r.x0, r.y0);
}

}  // namespace

bool is_sequence(const fs::path& file) {
  std::error_code ignored;
  return is_pattern(file) && !fs::exists(file, ignored);
}

FramePairs frame_pairs(const fs::path& image, const fs::path& reference, const std::string& frames) {
  const bool images = is_sequence(image), references = is_sequence(reference);
  if (!images && references)
    throw InputError(reference.string(), fmt::format("is a sequence, but {} is one image", image.string()),
                     "a sequence of both, or one reference of all frames");
  if (!images && !frames.empty())
    throw Error(ExitCode::bad_usage,
                fmt::format("--frames: {} is one image; accepted: with a pattern such as name.####.exr",
                            image.string()));
  if (!images) return {{{0, image, reference}}, false};
  FramePairs all{{}, true};
  const std::vector<int> wanted = wanted_frames(image, frames);
  if (wanted.empty()) throw InputError(image.string(), "no file has such a name", "at least one frame");
  const std::string a = missing_from(image, wanted), b = references ? missing_from(reference, wanted) : "";
  if (!a.empty() || !b.empty())
    throw InputError("frames are missing",
                     fmt::format("{}{}{}", a, a.empty() || b.empty() ? "" : ", and ", b),
                     fmt::format("all of {}; --frames chooses others", ranges_of(wanted)));
  for (const int f : wanted)
    all.pairs.push_back({f, file_of(image, f), references ? file_of(reference, f) : reference});
  return all;
}

std::optional<Image> layer_of(const ExrImage& image, std::string_view layer) {
  Image rgb(image.pixels.region(), 3);
  for (int c = 0; c < 3; ++c) {
    const int plane = image.plane(fmt::format("{}{}", layer, "RGB"[c]));
    if (plane < 0) return std::nullopt;
    std::ranges::copy(image.pixels.plane(plane), rgb.plane(c).begin());
  }
  return rgb;
}

Image rgb_of(const fs::path& file, const ExrImage& image) {
  if (auto rgb = layer_of(image, "")) return *std::move(rgb);
  throw InputError(file.string(), "has not all of the channels R, G and B", "files with R, G and B");
}

void require_same_region(const fs::path& x_file, const Region& x, const fs::path& r_file, const Region& r) {
  if (x != r)
    throw InputError(x_file.string(),
                     fmt::format("covers {}, but {} covers {}", text(x), r_file.string(), text(r)),
                     "images of the same pixels");
}

}  // namespace tessera
