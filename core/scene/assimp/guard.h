// SPDX-License-Identifier: Apache-2.0
// Files made safe for assimp, which trusts counts and nesting. Only for the files of this folder.
#pragma once

#include <string>
#include <string_view>

#include "core/scene/files.h"

namespace tessera::assimp {

// Throw InputError at `file`: of OBJ, if it is no text; of FBX, if records overlap or reach out of the file,
// nest too deeply, or unpack to more than file_bytes.
void check_obj(std::string_view bytes, const std::string& file);
void check_fbx(std::string_view bytes, const ImportLimits& limits, const std::string& file);

}  // namespace tessera::assimp
