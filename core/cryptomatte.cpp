// SPDX-License-Identifier: Apache-2.0
#include "core/cryptomatte.h"

#include <fmt/format.h>

#include <bit>
#include <cstring>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

std::uint32_t scrambled(std::uint32_t k) { return std::rotl(k * 0xcc9e2d51u, 15) * 0x1b873593u; }

}  // namespace

std::uint32_t murmur3(std::string_view text) {
  std::uint32_t h = 0;
  const std::size_t whole = text.size() & ~std::size_t{3};
  for (std::size_t i = 0; i < whole; i += 4) {
    std::uint32_t k;
    std::memcpy(&k, text.data() + i, 4);
    h = std::rotl(h ^ scrambled(k), 13) * 5 + 0xe6546b64u;
  }
  std::uint32_t tail = 0;
  std::memcpy(&tail, text.data() + whole, text.size() - whole);
  h ^= scrambled(tail);
  h ^= static_cast<std::uint32_t>(text.size());
  h = (h ^ (h >> 16)) * 0x85ebca6bu;
  h = (h ^ (h >> 13)) * 0xc2b2ae35u;
  return h ^ (h >> 16);
}

float matte_id(std::string_view name) {
  std::uint32_t bits = murmur3(name);
  const std::uint32_t exponent = (bits >> 23) & 255u;
  if (exponent == 0 || exponent == 255) bits ^= 1u << 23;
  return std::bit_cast<float>(bits);
}

std::map<std::string, std::string> matte_metadata(std::string_view layer,
                                                  const std::vector<std::string>& names) {
  nlohmann::json manifest = nlohmann::json::object();
  for (const std::string& name : names)
    manifest[name] = fmt::format("{:08x}", std::bit_cast<std::uint32_t>(matte_id(name)));
  const std::string prefix = fmt::format("cryptomatte/{:.7}/", fmt::format("{:08x}", murmur3(layer)));
  using Json = nlohmann::json;
  return {{prefix + "name", std::string(layer)},
          {prefix + "hash", "MurmurHash3_32"},
          {prefix + "conversion", "uint32_to_float32"},
          {prefix + "manifest", manifest.dump(-1, ' ', false, Json::error_handler_t::replace)}};
}

}  // namespace tessera
