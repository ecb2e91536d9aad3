// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/record_file.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <vector>

#include "coordinator/store/error.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "records are kept as they lie in memory");

constexpr std::uint32_t kMagic = 0x31435354;  // "TSC1"
constexpr std::uint32_t kMaxHeader = 1u << 28;
constexpr std::size_t kBuffer = std::size_t{1} << 20;
constexpr std::size_t kProbe = 512;  // a prefix and most headers

struct Prefix {
  std::uint32_t magic = kMagic;
  std::uint32_t header_bytes = 0;
  std::uint64_t plane_bytes = 0;
  std::array<char, 32> checksum{};
};
static_assert(sizeof(Prefix) == 48);

std::string binary(const Digest& digest) {
  const auto value = [](char c) { return c <= '9' ? c - '0' : c - 'a' + 10; };
  std::string bytes;
  for (std::size_t i = 0; i + 1 < digest.size(); i += 2)
    bytes += static_cast<char>(value(digest[i]) * 16 + value(digest[i + 1]));
  return bytes;
}

// Of all that the record is, the planes by their digest.
std::string checksum_of(std::string_view header, std::uint64_t plane_bytes, const Digest& planes) {
  const std::array<std::uint64_t, 2> lengths{header.size(), plane_bytes};
  Sha256 hash;
  hash.add(lengths.data(), sizeof lengths);
  hash.add(header.data(), header.size());
  hash.add(planes.data(), planes.size());
  return binary(hash.hex());
}

}  // namespace

Digest digest_of(std::span<const Bytes> planes) {
  Sha256 hash;
  for (const Bytes part : planes) hash.add(part.data(), part.size());
  return hash.hex();
}

std::uint64_t write_record(OpenFile& file, std::uint64_t offset, std::string_view header,
                           std::span<const Bytes> planes, const Digest& planes_digest) {
  Prefix prefix;
  prefix.header_bytes = static_cast<std::uint32_t>(header.size());
  for (const Bytes part : planes) prefix.plane_bytes += part.size();
  std::ranges::copy(checksum_of(header, prefix.plane_bytes, planes_digest), prefix.checksum.begin());
  std::vector<Bytes> parts{std::as_bytes(std::span(&prefix, 1)), bytes_of(header)};
  parts.insert(parts.end(), planes.begin(), planes.end());
  file.write(offset, parts);
  return offset + sizeof prefix + header.size() + prefix.plane_bytes;
}

std::optional<StoredRecord> read_record(const OpenFile& file, std::uint64_t offset) {
  std::array<std::byte, kProbe> probe;
  const std::size_t probed = file.read(offset, probe);
  Prefix prefix;
  if (probed < sizeof prefix) return std::nullopt;
  std::memcpy(&prefix, probe.data(), sizeof prefix);
  const std::uint64_t size = file.size(), begin = offset + sizeof prefix, left = size - std::min(size, begin);
  if (prefix.magic != kMagic || prefix.header_bytes > std::min<std::uint64_t>(left, kMaxHeader) ||
      prefix.plane_bytes > left - prefix.header_bytes)
    return std::nullopt;
  StoredRecord record{.header = std::string(prefix.header_bytes, '\0'),
                      .planes_at = begin + prefix.header_bytes,
                      .plane_bytes = prefix.plane_bytes,
                      .checksum = std::string(prefix.checksum.begin(), prefix.checksum.end())};
  const std::size_t there = std::min<std::size_t>(probed - sizeof prefix, prefix.header_bytes);
  std::memcpy(record.header.data(), probe.data() + sizeof prefix, there);
  const auto rest = std::as_writable_bytes(std::span(record.header)).subspan(there);
  if (!rest.empty() && file.read(begin + there, rest) != rest.size()) return std::nullopt;
  return record;
}

bool is_sound(const OpenFile& file, const StoredRecord& record) {
  std::vector<std::byte> buffer(std::min<std::uint64_t>(kBuffer, record.plane_bytes));
  Sha256 hash;
  for (std::uint64_t at = record.planes_at; at < record.end();) {
    const auto some = std::span(buffer).first(std::min<std::uint64_t>(buffer.size(), record.end() - at));
    if (file.read(at, some) != some.size()) return false;
    hash.add(some.data(), some.size());
    at += some.size();
  }
  return checksum_of(record.header, record.plane_bytes, hash.hex()) == record.checksum;
}

void read_planes(const OpenFile& file, std::uint64_t offset, std::span<float> to) {
  const auto bytes = std::as_writable_bytes(to);
  if (file.read(offset, bytes) != bytes.size()) throw StoreDamaged(file.path(), "ends too early");
}

}  // namespace tessera
