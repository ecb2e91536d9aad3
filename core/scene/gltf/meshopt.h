// SPDX-License-Identifier: Apache-2.0
// Buffer views under EXT_meshopt_compression. Only for the files of this folder.
#pragma once

#include "core/scene/gltf/document.h"

namespace tessera::gltf {

// Decodes the buffer view into document.decoded if it is compressed. Throws InputError if it is broken.
void decompress(Document& document, int buffer_view);

}  // namespace tessera::gltf
