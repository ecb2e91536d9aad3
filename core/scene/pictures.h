// SPDX-License-Identifier: Apache-2.0
// Image files to pictures, through OpenImageIO; and the shelf of a scene's pictures, each looked at once.
#pragma once

#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <tuple>

#include "core/scene/scene.h"

namespace tessera {

inline constexpr int kMaxPictureEdge = 16384;                   // pixels
inline constexpr std::uint64_t kMaxPictureFloats = 1ull << 28;  // 1 GiB
inline constexpr std::uint64_t kMaxPictureBytes = 1ull << 30;   // of the file

// Whether a scene holds a picture's pixels, or only knows where they are.
enum class Keep : std::uint8_t { source, pixels };

// Throw InputError that begins with `where`, or else the file's name, unless this is a whole image of a
// format we know, with 1 to 4 channels and within the limits above: it is decoded whatever is kept. NaN
// becomes 0, infinity the largest half.
Picture read_picture(const std::filesystem::path& file, Encoding, std::string_view where = {},
                     Keep = Keep::pixels);
Picture decode_picture(std::span<const unsigned char> bytes, const std::string& name, Encoding,
                       Keep = Keep::pixels);

// A file name with this in it means all files that have a tile's number (1001 to 9999) in its place.
inline constexpr std::string_view kUdim = "<UDIM>";

// The picture of all those tiles, by source. Throws InputError if there are none or one is bad.
Picture read_udims(const std::filesystem::path& pattern, Encoding, std::string_view where = {});

// A copy with its pixels, read again if it does not hold them. Not of a picture with tiles, but of one of
// those. Throws InputError if the image is gone or is not, to the bit, what it was when the scene was loaded.
Picture with_pixels(const Picture&);

// Of all pictures of one scene file: what the scene holds, and how many values they have.
inline constexpr std::uint64_t kMaxShelfBytes = 1ull << 33, kMaxShelfValues = 1ull << 36;

// Adds pictures to a scene, and their files to what it was made from: the same file in the same encoding is
// there once.
class PictureShelf {
 public:
  // The scene is borrowed and outlives the shelf. Files outside of the roots are refused (roots.h).
  explicit PictureShelf(Scene& scene, std::vector<std::filesystem::path> roots = {})
      : scene_(scene), roots_(std::move(roots)) {}

  // The index of the picture in the scene. The file's name may contain <UDIM> unless pixels are to be kept.
  int place(const std::filesystem::path& file, Encoding, std::string_view where = {}, Keep = Keep::source);
  int place(std::span<const unsigned char> bytes, const std::string& name, Encoding);

 private:
  template <class Decode>
  int place_once(const std::string& name, Encoding, Keep, const Decode&);

  // Notes the files of a picture, which must lie within the roots.
  void note(const Picture&, std::string_view where);

  Scene& scene_;
  std::vector<std::filesystem::path> roots_;
  std::uint64_t bytes_ = 0, values_ = 0;  // of all pictures placed
  std::map<std::tuple<std::string, Encoding, Keep>, int> placed_;
};

}  // namespace tessera
