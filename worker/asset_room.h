// SPDX-License-Identifier: Apache-2.0
// How the folder of an AssetCache stays within its limit. Only for asset_cache.
#pragma once

#include <cstdint>
#include <filesystem>
#include <memory>
#include <set>

#include "core/sha256.h"

namespace tessera {

class FileLock;

// The lock of a bundle, shared. Waits while anybody makes room: who looks at one bundle after the other would
// find one of a user's in use that is left by then, and the one that he takes instead.
std::shared_ptr<FileLock> hold(const std::filesystem::path& folder, const std::filesystem::path& lock_file);

// Removes what has not been used for the longest: blobs that are in no bundle, and bundles that nobody holds,
// until there is room for `needed` bytes more. Blobs in `keep` stay. One call at a time, of all processes.
// Throws Error(internal_error) if what is in use leaves no room, with how much that is.
void make_room(const std::filesystem::path& folder, std::uint64_t limit, std::uint64_t needed,
               const std::set<Digest>& keep);

}  // namespace tessera
