// SPDX-License-Identifier: Apache-2.0
// Where the files that a scene names may lie, when the scene comes from elsewhere or is to go there.
#pragma once

#include <filesystem>
#include <string_view>
#include <vector>

namespace tessera {

// True unless there are roots and `file` lies in none of them, by its name or by where symbolic links lead.
bool lies_within(const std::vector<std::filesystem::path>& roots, const std::filesystem::path& file);

// The file to be read for `file`: that itself if there are no roots; else its name without "." and "..", so
// that it is the same wherever the roots' files are unpacked. Throws InputError, at `where` or else at the
// file's name, unless it lies within the roots.
std::filesystem::path within(const std::vector<std::filesystem::path>& roots,
                             const std::filesystem::path& file, std::string_view where = {});

}  // namespace tessera
