// SPDX-License-Identifier: Apache-2.0
// Names as Cryptomatte writes them (Friedman and Jones 2015; Cryptomatte specification 1.2.0).
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// MurmurHash3_x86_32 with seed 0 (Appleby 2011).
std::uint32_t murmur3(std::string_view text);

// The hash as a float that is finite, normal and not 0: the specification's uint32_to_float32, which flips
// the lowest bit of the exponent where it would be all zeros or all ones.
float matte_id(std::string_view name);

// The attributes of one layer: cryptomatte/<7 hex>/{name, hash, conversion, manifest}.
std::map<std::string, std::string> matte_metadata(std::string_view layer,
                                                  const std::vector<std::string>& names);

}  // namespace tessera
