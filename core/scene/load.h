// SPDX-License-Identifier: Apache-2.0
// Files to Scene: the native JSON (docs/scene.schema.json), .gltf/.glb, .obj, .fbx, .ply. Chosen by the
// file's extension. Everything in a file is untrusted: a bad one throws InputError with file, line or JSON
// pointer, what is wrong and what is accepted.
#pragma once

#include <filesystem>
#include <string>

#include "core/scene/limits.h"
#include "core/scene/scene.h"

namespace tessera {

// The scene of `file`, complete and valid: every index in range, every number finite, at least one camera
// (one that frames the scene is added if the file has none).
Scene load_scene(const std::filesystem::path& file, const ImportLimits& = {});

// Hex digest of everything in the scene that can change a pixel. Equal scenes have equal hashes on every
// machine.
std::string content_hash(const Scene&);

// The JSON Schema of the native format, as published in docs/.
std::string_view scene_schema();

// The index of the camera of that name, or 0 if `name` is empty. Throws InputError listing the cameras there
// are.
int camera_index(const Scene&, std::string_view name);

// The variant of that name, or null if `name` is empty. Throws InputError listing the variants there are.
const Variant* variant_of(const Scene&, std::string_view name);

}  // namespace tessera
