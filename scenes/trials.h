// SPDX-License-Identifier: Apache-2.0
// Small scenes on which filters are judged, each with one thing that is hard for some of them.
#pragma once

#include <filesystem>
#include <string_view>

namespace tessera::scenes {

// box_diffuse box_glossy box_glass: a Cornell box with what van de Vlasakker (2013) puts into his. sphere:
// under a picture of a sky, as in Kim et al. (2016). outside: a terrace under that sky and the sun. shadow:
// wide soft shadows on plain walls. glossy: metals and clear coats of many roughnesses. focus: depth of field
// over tiles.
inline constexpr std::string_view kTrials[] = {"box_diffuse", "box_glossy", "box_glass", "sphere",
                                               "outside",     "shadow",     "glossy",    "focus"};

// Writes NAME.json of each, and the pictures they refer to, into `folder`. The same bytes every time.
void write_trials(const std::filesystem::path& folder);

}  // namespace tessera::scenes
