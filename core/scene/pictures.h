// SPDX-License-Identifier: Apache-2.0
// Image files to linear pixels, through OpenImageIO; and the shelf of a scene's pictures, each decoded once.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <utility>

#include "core/scene/scene.h"

namespace tessera {

// What the numbers of an integer file mean. .hdr and .exr are linear whatever is asked for.
enum class Encoding { srgb, linear };

inline constexpr int kMaxPictureEdge = 16384;                   // pixels
inline constexpr std::uint64_t kMaxPictureFloats = 1ull << 28;  // 1 GiB
inline constexpr std::uint64_t kMaxPictureBytes = 1ull << 30;   // of the file

// Throw InputError that begins with `where`, or else the file's name, unless this is a whole image of a
// format we know, with 1 to 4 channels and within the limits above. NaN becomes 0, infinity the largest half.
Picture read_picture(const std::filesystem::path& file, Encoding, std::string_view where = {});
Picture decode_picture(std::span<const unsigned char> bytes, const std::string& name, Encoding);

inline constexpr std::uint64_t kMaxShelfFloats = 1ull << 31;  // of all pictures of one scene file: 8 GiB

// Adds pictures to a scene: the same file in the same encoding is there once.
class PictureShelf {
 public:
  explicit PictureShelf(Scene& scene) : scene_(scene) {}  // borrowed; outlives the shelf

  // The index of the picture in the scene.
  int place(const std::filesystem::path& file, Encoding, std::string_view where = {});
  int place(std::span<const unsigned char> bytes, const std::string& name, Encoding);

 private:
  template <class Decode>
  int place_once(const std::string& name, Encoding, const Decode&);

  Scene& scene_;
  std::uint64_t floats_ = 0;  // of all pictures placed
  std::map<std::pair<std::string, Encoding>, int> placed_;
};

}  // namespace tessera
