// SPDX-License-Identifier: Apache-2.0
// Layered OpenEXR files in and out. With core/exr_parts the only files that see OpenEXR.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "core/image.h"

namespace tessera {

// What a file holds of a plane, which is of floats always.
enum class ExrType { half, float32, uint32 };

// One named plane of a file, e.g. "R", "albedo.G", "Z".
struct ExrChannel {
  std::string name;
  ExrType type = ExrType::half;
  bool operator==(const ExrChannel&) const = default;
};

// Attributes of a file that tessera does not look at: matrices, chromaticities, time codes and the like.
struct ExrAttributes;

struct ExrImage {
  Region display;  // the whole frame
  Image pixels;    // over the data window; one plane per channel
  std::vector<ExrChannel> channels;
  std::map<std::string, std::variant<std::string, float, int>> metadata;  // by attribute name
  std::shared_ptr<const ExrAttributes> others;  // as read; written again as they are. May be null
  // By the names of uint32 channels that were read: what their planes stand for, if floats do not hold it. A
  // plane that was changed, cropped or renamed needs nothing to be done here: see write_exr.
  std::map<std::string, std::shared_ptr<const std::vector<std::uint32_t>>> integers;

  // The plane of that channel, or -1.
  int plane(std::string_view channel) const;
  // The metadata of that name: a std::string, float or int; null if there is none, or one of another kind.
  template <typename T>
  const T* about(const std::string& name) const {
    const auto at = metadata.find(name);
    return at == metadata.end() ? nullptr : std::get_if<T>(&at->second);
  }
};

// Scanlines, top down; the channels in the file are sorted by name, whatever their order here. Finite values
// beyond what a half can hold become +-65504; infinities stay infinite, NaN stays NaN. Of a uint32 channel a
// pixel becomes its integer in `integers`, where the plane still has that integer's float; else the plane's
// value, rounded, from 0 (NaN, too) to 2^32 - 1. Written beside `file` and renamed, so a reader never sees
// half of it. Throws InputError for an unknown compression, doubled or empty channel names, and a place that
// cannot be written.
void write_exr(const std::filesystem::path& file, const ExrImage&, const std::string& compression = "zip");

// The bytes of such a file, which are the same for the same picture. Throws InputError for the same names.
std::string exr_bytes(const ExrImage&, const std::string& compression = "zip");

// Reads scanline and tiled files. Parts become layers of one image: a channel without a dot in its name
// becomes PART.CHANNEL, except in the first part; written again they are a single part. Channels come sorted
// by name; integers as floats, and in `integers`. Metadata are the attributes that are strings, floats or
// ints, of parts with different ones the first's. Throws InputError for a file that is missing, not an EXR,
// corrupt or incomplete; that has deep parts, parts of different data windows, or two channels that would
// have one name; or that is absurdly large: edges above 65536, 1024 channels, more than `most_values` (of
// integers half as many), or more pixels than the file's bytes can hold, all parts together.
inline constexpr std::int64_t kMostExrValues = std::int64_t{1} << 31;
ExrImage read_exr(const std::filesystem::path& file, std::int64_t most_values = kMostExrValues);

// OpenEXR's names: none rle zips zip piz pxr24 b44 b44a dwaa dwab.
const std::vector<std::string>& exr_compressions();

}  // namespace tessera
