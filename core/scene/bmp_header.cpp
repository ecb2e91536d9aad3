// SPDX-License-Identifier: Apache-2.0
#include "core/scene/bmp_header.h"

#include <cstdint>
#include <cstdlib>
#include <cstring>

namespace tessera {
namespace {

constexpr std::size_t kFileHeader = 14;
constexpr std::uint32_t kCoreHeader = 12, kInfoHeader = 40, kLargestHeader = 124;
constexpr std::uint32_t kUncompressed = 0, kBitFields = 3;

// Little-endian, as this machine is. Precondition: it lies in the bytes.
template <typename T>
T number_at(std::string_view bytes, std::size_t at) {
  T value{};
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

struct Promise {
  std::int64_t width = 0, height = 0;
  std::uint64_t bits = 0;     // of a pixel
  std::uint64_t palette = 0;  // bytes
};

Promise promise_of(std::string_view bytes, std::uint32_t header) {
  if (header == kCoreHeader) {
    const auto bits = number_at<std::uint16_t>(bytes, 24);
    return {number_at<std::uint16_t>(bytes, 18), number_at<std::uint16_t>(bytes, 20), bits,
            bits <= 8 ? 3ull << bits : 0};
  }
  const auto bits = number_at<std::uint16_t>(bytes, 28);
  const std::uint64_t colours = number_at<std::uint32_t>(bytes, 46);
  return {number_at<std::int32_t>(bytes, 18), std::llabs(number_at<std::int32_t>(bytes, 22)), bits,
          4 * (colours > 0 ? colours
               : bits <= 8 ? 1ull << bits
                           : 0)};
}

bool known(std::uint64_t bits) {
  return bits == 1 || bits == 4 || bits == 8 || bits == 16 || bits == 24 || bits == 32;
}

}  // namespace

bool bmp_fits(std::string_view bytes) {
  if (bytes.size() < kFileHeader + kCoreHeader) return false;
  const std::uint64_t pixels = number_at<std::uint32_t>(bytes, 10);
  const auto header = number_at<std::uint32_t>(bytes, kFileHeader);
  if (header != kCoreHeader && (header < kInfoHeader || header > kLargestHeader)) return false;
  if (bytes.size() < kFileHeader + header) return false;
  const std::uint32_t compression =
      header == kCoreHeader ? kUncompressed : number_at<std::uint32_t>(bytes, 30);
  if (compression != kUncompressed && compression != kBitFields) return false;
  const Promise p = promise_of(bytes, header);
  if (!known(p.bits) || p.width < 1 || p.height < 1) return false;
  const std::uint64_t row = (static_cast<std::uint64_t>(p.width) * p.bits + 31) / 32 * 4;
  return kFileHeader + header + p.palette <= bytes.size() && pixels >= kFileHeader + header &&
         pixels <= bytes.size() && row <= (bytes.size() - pixels) / static_cast<std::uint64_t>(p.height);
}

}  // namespace tessera
