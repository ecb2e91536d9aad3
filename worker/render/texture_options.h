// SPDX-License-Identifier: Apache-2.0
// What a process spends on textures.
#pragma once

#include <cstdint>
#include <filesystem>

namespace tessera {

struct TextureOptions {
  std::filesystem::path folder;       // of converted pictures; empty: see worker/render/texture_folder.h
  std::uint64_t memory = 1ull << 30;  // bytes of texels held in memory; below 10 MiB counts as that
};

}  // namespace tessera
