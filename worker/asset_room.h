// SPDX-License-Identifier: Apache-2.0
// How the folder of an AssetCache stays within its limit. Only for asset_cache.
#pragma once

#include <cstdint>
#include <filesystem>
#include <set>

#include "core/sha256.h"

namespace tessera {

// Removes what has not been used for the longest: blobs that are in no bundle, and bundles that nobody holds,
// until there is room for `needed` bytes more. Blobs in `keep` stay. Throws Error(internal_error) if what is
// in use leaves no room, with how much that is.
void make_room(const std::filesystem::path& folder, std::uint64_t limit, std::uint64_t needed,
               const std::set<Digest>& keep);

}  // namespace tessera
