// SPDX-License-Identifier: Apache-2.0
// The pictures of the demo scenes: glazed tiles, ripples on water, an evening sky.
#pragma once

#include <filesystem>

namespace tessera::scenes {

// tiles.png (colour), tiles_normal.png and tiles_rough.png (green: roughness): one star tile of an Andalusian
// kind, to be repeated.
void paint_tiles(const std::filesystem::path& folder);

// ripples.png: a tangent-space normal map that repeats.
void paint_ripples(const std::filesystem::path& folder);

// sky.hdr: blue above, a warm band along the horizon that is brightest around the sun's bearing (radians from
// -Z towards +X).
void paint_sky(const std::filesystem::path& folder, float sun_bearing);

}  // namespace tessera::scenes
