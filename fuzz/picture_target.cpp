// SPDX-License-Identifier: Apache-2.0
// The bytes are an image file: it is decoded, or refused with an InputError.
#include "core/error.h"
#include "core/scene/pictures.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    tessera::decode_picture({data, size}, "input", tessera::Encoding::srgb);
  } catch (const tessera::InputError&) {
  }
  return 0;
}
