// SPDX-License-Identifier: Apache-2.0
// Scenes in motion on which filters are judged that go by the frame before. Each moves for kShotFrames
// frames.
#pragma once

#include <filesystem>
#include <string_view>

namespace tessera::scenes {

// flight: a walk through the courtyard. glossy_flight: the same, all surfaces glossy. still: the courtyard,
// nothing moves. light: a room in which the lamp wanders, and nothing else. object: a crate that slides and
// turns over a terrace.
inline constexpr std::string_view kShots[] = {"flight", "glossy_flight", "still", "light", "object"};
inline constexpr int kShotFrames = 60;

// Writes NAME.json of each, and what they refer to, into `folder`. The same bytes every time.
void write_shots(const std::filesystem::path& folder);

}  // namespace tessera::scenes
