// SPDX-License-Identifier: Apache-2.0
// CURVE key pairs, and the files in which they are kept. A key is 32 bytes, written as 40 characters (Z85).
// What a key may do is not said here but in the coordinator's allow-list (proto/allow_list.h).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

inline constexpr std::size_t kKeyText = 40;

struct KeyPair {
  std::string public_key, secret_key;
  bool operator==(const KeyPair&) const = default;
};

// A new one, from the system's source of randomness.
KeyPair make_key_pair();

// True for 40 characters of the Z85 alphabet.
bool is_key(std::string_view);

// One line "secret-key KEY". Throws InputError, also if anybody but its owner may read the file.
KeyPair read_secret_key(const std::filesystem::path&);

// Lines "public-key KEY", at least one: while a coordinator's key is changed, its old and its new one.
// Throws InputError.
std::vector<std::string> read_public_keys(const std::filesystem::path&);

// `stem`.key with mode 0600 and `stem`.pub. Throws Error(bad_usage) if either is there already, InputError if
// they cannot be written.
void write_key_files(const std::filesystem::path& stem, const KeyPair&);

}  // namespace tessera
