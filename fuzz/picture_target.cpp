// SPDX-License-Identifier: Apache-2.0
// The bytes are an image file: it is refused with an InputError, or is whole; then it has all its pixels.
#include <cstdlib>

#include "core/error.h"
#include "core/scene/pictures.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    using namespace tessera;
    const Picture whole = decode_picture({data, size}, "input", Encoding::srgb, Keep::source);
    if (with_pixels(whole).pixels.empty()) std::abort();
  } catch (const tessera::InputError&) {
  }
  return 0;
}
