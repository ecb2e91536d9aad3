// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/kept_image.h"

#include <array>
#include <cstdint>

#include "coordinator/store/error.h"
#include "coordinator/store/record_file.h"
#include "proto/frame_codec.h"

namespace tessera {

// The header's length, the header, the planes.
Digest put_image(BlobStore& blobs, const Image& image) {
  const std::string header = header_of(image);
  const std::uint64_t length = header.size();
  const std::array<Bytes, 3> parts{std::as_bytes(std::span(&length, 1)), bytes_of(header),
                                   std::as_bytes(image.data())};
  return blobs.put(parts);
}

Image get_image(BlobStore& blobs, const Digest& blob) {
  blobs.check(blob);
  const OpenFile file(blobs.path(blob), OpenFile::Mode::read);
  const std::uint64_t size = file.size();
  std::uint64_t length = 0;
  if (file.read(0, std::as_writable_bytes(std::span(&length, 1))) != sizeof length ||
      length > size - sizeof length)
    throw StoreDamaged(file.path(), "is not an image");
  std::string header(length, '\0');
  file.read(sizeof length, std::as_writable_bytes(std::span(header)));
  Image image = image_from(header, size - sizeof length - length);
  read_planes(file, sizeof length + length, image.data());
  return image;
}

}  // namespace tessera
