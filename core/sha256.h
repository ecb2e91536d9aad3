// SPDX-License-Identifier: Apache-2.0
// SHA-256 (FIPS 180-4) of bytes that come in pieces.
#pragma once

#include <cstddef>
#include <filesystem>
#include <memory>
#include <string>
#include <string_view>

namespace tessera {

class Sha256 {
 public:
  Sha256();
  void add(const void* data, std::size_t bytes);
  std::string hex();  // 64 lower-case digits; the end: nothing may be added after it

 private:
  struct Free {
    void operator()(void* context) const;
  };
  std::unique_ptr<void, Free> context_;
};

std::string sha256(std::string_view bytes);
// Of what is in the file; empty if it cannot be read to its end.
std::string sha256_of_file(const std::filesystem::path& file);

// What a thing is known by: the SHA-256 of its bytes, as hex() writes it.
using Digest = std::string;
bool is_digest(std::string_view text);

}  // namespace tessera
