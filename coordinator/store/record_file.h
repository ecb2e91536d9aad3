// SPDX-License-Identifier: Apache-2.0
// Records one behind the other in a file: a header, and planes of floats, under one checksum. What was
// written in part, or changed afterwards, is not taken for a record.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "coordinator/store/file.h"
#include "core/sha256.h"

namespace tessera {

struct StoredRecord {
  std::string header;
  std::uint64_t planes_at = 0;  // offset in the file
  std::uint64_t plane_bytes = 0;
  std::uint64_t end() const { return planes_at + plane_bytes; }
  std::string checksum;  // 32 bytes
};

Digest digest_of(std::span<const Bytes> planes);

// In one write. `planes_digest`: digest_of(planes). Returns the record's end. Throws StoreFull or StoreError,
// and nothing is written.
std::uint64_t write_record(OpenFile& file, std::uint64_t offset, std::string_view header,
                           std::span<const Bytes> planes, const Digest& planes_digest);
// None if no whole record begins there. Whether its bytes are those that were written is not looked at.
std::optional<StoredRecord> read_record(const OpenFile& file, std::uint64_t offset);
// Reads its planes: whether all of it is as it was written.
bool is_sound(const OpenFile& file, const StoredRecord& record);
void read_planes(const OpenFile& file, std::uint64_t offset, std::span<float> to);

}  // namespace tessera
