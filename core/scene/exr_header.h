// SPDX-License-Identifier: Apache-2.0
// What OpenEXR trusts in the header of a file, looked at before it does.
#pragma once

#include <string_view>

namespace tessera {

// Whether every attribute of a file's headers lies in the file ("OpenEXR File Layout", Header): OpenEXR makes
// room for as many bytes as an attribute promises. Of bytes that are no OpenEXR file it says nothing.
bool exr_attributes_fit(std::string_view bytes);

}  // namespace tessera
