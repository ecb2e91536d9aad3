// SPDX-License-Identifier: Apache-2.0
// Whole files in memory, how they are called in messages, and how much a scene may hold.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace tessera {

// The bytes of `file`. Throws InputError, at `where` or else at the file's name, if there is no such regular
// file, it cannot be read, or it is longer than `most` bytes.
std::string read_file(const std::filesystem::path& file, std::uint64_t most, std::string_view where = {});

// Throws InputError at `where` if there are more than `most` of `things`.
void require_at_most(std::uint64_t most, std::uint64_t count, std::string_view things,
                     std::string_view where);

// Lower case, with the dot: ".gltf".
std::string extension_of(const std::filesystem::path& file);

}  // namespace tessera
