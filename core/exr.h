// SPDX-License-Identifier: Apache-2.0
// Layered OpenEXR files in and out. The only file pair that sees OpenEXR.
#pragma once

#include <filesystem>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "core/image.h"

namespace tessera {

// One named plane of a file, e.g. "R", "albedo.G", "Z".
struct ExrChannel {
  std::string name;
  bool half = true;  // else 32-bit float
};

struct ExrImage {
  Region display;  // the whole frame
  Image pixels;    // over the data window; one plane per channel
  std::vector<ExrChannel> channels;
  std::map<std::string, std::variant<std::string, float, int>> metadata;

  // The plane of that channel, or -1.
  int plane(std::string_view channel) const;
};

// Written beside `file` and renamed, so a reader never sees half of it. Throws Error.
void write_exr(const std::filesystem::path& file, const ExrImage&, const std::string& compression = "zip");

// Throws InputError for a file that is missing, not an EXR, corrupt, or absurdly large.
ExrImage read_exr(const std::filesystem::path& file);

// OpenEXR's names: none rle zips zip piz pxr24 b44 b44a dwaa dwab.
const std::vector<std::string>& exr_compressions();

}  // namespace tessera
