// SPDX-License-Identifier: Apache-2.0
// Images as blobs, bit for bit: what a frame keeps for the next one.
#pragma once

#include "coordinator/store/blob_store.h"
#include "core/image.h"

namespace tessera {

Digest put_image(BlobStore& blobs, const Image& image);
// Throws StoreError if it is not there, StoreDamaged if it is not what it was.
Image get_image(BlobStore& blobs, const Digest& blob);

}  // namespace tessera
