// SPDX-License-Identifier: Apache-2.0
// What OpenImageIO trusts in the header of a BMP file, looked at before it does.
#pragma once

#include <string_view>

namespace tessera {

// Whether the file holds all the pixels and colours that its header promises ("Windows Bitmap",
// BITMAPFILEHEADER and BITMAPCOREHEADER to BITMAPV5HEADER): OpenImageIO makes room for them, and reads from
// where they are said to be. Compressed files, which tell only while they are read, are refused.
bool bmp_fits(std::string_view bytes);

}  // namespace tessera
