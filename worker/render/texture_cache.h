// SPDX-License-Identifier: Apache-2.0
// Texels on disk and, as far as a limit allows, in memory: OpenImageIO's texture system behind a few calls.
// A picture is converted once to a tiled, mip-mapped OpenEXR file of linear values (half floats, or floats if
// the scene gave the pixels as such), named by what is in it, so that a changed picture gets another file.
#pragma once

#include <cstdint>
#include <memory>
#include <string>

#include "core/scene/scene.h"
#include "worker/render/texture_options.h"

namespace tessera::tracer {

// Safe to use from any thread. What a lookup returns depends on the picture alone, not on what is in memory.
class TextureCache {
 public:
  explicit TextureCache(const TextureOptions& = {});
  ~TextureCache();
  TextureCache(const TextureCache&) = delete;
  TextureCache& operator=(const TextureCache&) = delete;

  // Makes the folder ready, as the first open() does: throws Error if it cannot be used. What the user should
  // know about it; empty: nothing.
  const std::string& warning();

  // A picture without tiles, ready to be looked up while the cache lives.
  struct Image {
    void* handle = nullptr;
    int channels = 0;
    float scale = 1.0f;  // of widths: OpenImageIO measures a footprint by the shorter edge, we by the area
  };
  // Converts the picture unless it has been. Throws InputError if it cannot be read any more or has changed,
  // Error if nothing can be written.
  Image open(const Picture&);

  // Where a value is and over how much of the picture it is averaged. (0, 0) is the top left corner.
  struct Footprint {
    float u, v;
    float width;  // diameter in texture coordinates; 0: the finest level; from 2: the mean of the picture
  };
  // Linear between texels and between levels. False, with `message` set, if the file cannot be read.
  bool sample(const Image&, Texture::Wrap u, Texture::Wrap v, const Footprint&, float* values,
              std::string& message) const;
  std::uint64_t memory_used() const;  // bytes of texels

 private:
  class System;
  std::unique_ptr<System> system_;
};

}  // namespace tessera::tracer
