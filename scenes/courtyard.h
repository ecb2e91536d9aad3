// SPDX-License-Identifier: Apache-2.0
// An arcaded courtyard in the evening: low sun, glazed tiles, a basin with a fountain, brass lanterns, orange
// trees. Some 300,000 triangles by instancing.
#pragma once

#include <filesystem>

namespace tessera::scenes {

// Writes courtyard.json and what it refers to into `folder`. The same bytes every time.
void write_courtyard(const std::filesystem::path& folder);

}  // namespace tessera::scenes
