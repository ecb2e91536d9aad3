// SPDX-License-Identifier: Apache-2.0
// Scenes as text in the native format.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/scene/json.h"
#include "core/scene/scene.h"

namespace tessera {

// Meshes stand in the file itself if they are not larger than this, all together.
inline constexpr std::size_t kMaxInlineVertices = 20'000, kMaxInlineTriangles = 20'000;

// Why the whole scene cannot stand in one file, with nothing beside it but pictures; nothing if it can.
std::optional<std::string> obstacle_to_inline(const Scene&);

// All of the scene. Pictures are named relative to `folder`, where the text is to lie. Needs that nothing is
// in the way.
std::string whole_scene_text(const Scene&, const std::filesystem::path& folder);

// A scene that imports `file`, relative to `folder`. `scene` is what the file loads as: the camera and the
// light that loading adds are written out, and the materials with a name of their own, but for their
// textures, to be edited.
std::string importing_text(const Scene& scene, const std::filesystem::path& file,
                           const std::filesystem::path& folder);

}  // namespace tessera
