// SPDX-License-Identifier: Apache-2.0
// What OpenEXR trusts in the header of a file, looked at before it does.
#pragma once

#include <cstdint>
#include <string_view>

namespace tessera {

// Each part has a channel, and 1024 channels are the most (core/exr.h).
inline constexpr int kMostExrParts = 1024;

enum class ExrHeaders {
  fit,
  lie,
  too_many,  // parts: OpenEXR keeps several times their bytes
  longer,    // than the bytes that are there
};

// Whether every attribute of a file's headers (several parts have one each) lies in the file ("OpenEXR File
// Layout", Header), for OpenEXR makes room for as many bytes as an attribute promises; whether values whose
// type tells their length have it, for OpenEXR goes by that; and whether no data window or tile has an edge
// of more than `most_edge` pixels (0: whatever they are), for it makes room for rows of them before anybody
// can look. `start`: the file's first bytes. Bytes that are no OpenEXR file fit.
ExrHeaders exr_headers(std::string_view start, std::uintmax_t file_bytes, int most_edge);

// Whether they fit as far as they are there.
bool exr_header_fits(std::string_view start, std::uintmax_t file_bytes, int most_edge);

}  // namespace tessera
