// SPDX-License-Identifier: Apache-2.0
// Pictures made for one test, and a folder for what they are converted to.
#pragma once

#include <gtest/gtest.h>

#include "core/scene/pictures.h"
#include "tests/core/scene/folder.h"
#include "worker/render/texture.h"

namespace tessera::tracer {

// An uncompressed Targa file, row 0 on top: grey(x, y) in all channels.
template <class Grey>
std::string targa(int width, int height, const Grey& grey) {
  std::string bytes(18, '\0');
  bytes[2] = 2;  // true colour
  bytes[12] = static_cast<char>(width & 255), bytes[13] = static_cast<char>(width >> 8);
  bytes[14] = static_cast<char>(height & 255), bytes[15] = static_cast<char>(height >> 8);
  bytes[16] = 24;
  bytes[17] = 0x20;  // the first row is the top
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) bytes.append(3, static_cast<char>(grey(x, y)));
  return bytes;
}

class TextureTest : public ::testing::Test {
 protected:
  // A scene whose materials look up all pictures that are placed in it.
  void use(int picture) { scene_.materials.emplace_back().base_color_texture.picture = picture; }
  int place(const std::filesystem::path& file, Encoding encoding = Encoding::srgb) {
    PictureShelf shelf(scene_);
    const int index = shelf.place(file, encoding);
    use(index);
    return index;
  }
  int add(int width, int height, int channels, std::vector<float> pixels) {
    scene_.pictures.push_back({"pixels", width, height, channels, std::move(pixels)});
    const int index = static_cast<int>(scene_.pictures.size()) - 1;
    use(index);
    return index;
  }
  std::shared_ptr<TextureCache> cache(std::uint64_t memory = 64 << 20) const {
    return std::make_shared<TextureCache>(TextureOptions{folder_.path() / "cache", memory});
  }

  Folder folder_;
  Scene scene_;
};

}  // namespace tessera::tracer
