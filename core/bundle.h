// SPDX-License-Identifier: Apache-2.0
// The files of a scene as they travel: which there are, under which names, and what is in them. Where a
// bundle is unpacked, its scene file loads as the scene that it was made from. As text, whose SHA-256 is what
// the bundle is known by:
//
//   tessera bundle 1
//   shots/atrium.json
//   <digest> <bytes> <path>      one line a file, by rising path
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "core/sha256.h"

namespace tessera {

// What a reader accepts.
inline constexpr std::size_t kMaxBundleText = std::size_t{1} << 26;
inline constexpr std::size_t kMaxBundleFiles = 100'000;
inline constexpr std::size_t kMaxBundlePath = 1024;                       // bytes
inline constexpr std::uint64_t kMaxBundleBytes = std::uint64_t{1} << 40;  // of all files

struct Bundle {
  struct File {
    std::string path;
    Digest digest;
    std::uint64_t bytes = 0;
    bool operator==(const File&) const = default;
  };
  std::string scene;        // path of the scene file
  std::vector<File> files;  // by rising path; the scene file is one of them

  bool operator==(const Bundle&) const = default;
};

// 1 to 1024 bytes, parts of 1 to 255 bytes that are joined by single '/', none of them "." or ".."; no
// control characters.
bool is_bundle_path(std::string_view);

// Throws InputError that names the path unless paths are as they must be, rise, and none is a folder of
// another; and the rest is within the bounds above.
void validate(const Bundle&);

// Equal bundles are equal texts. Precondition: validate() accepts it.
std::string to_text(const Bundle&);

// Throws InputError unless to_text() writes this for a bundle that validate() accepts.
Bundle parse_bundle(std::string_view text);

}  // namespace tessera
