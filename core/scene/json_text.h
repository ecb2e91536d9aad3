// SPDX-License-Identifier: Apache-2.0
// JSON values as text that people like to read.
#pragma once

#include <string>

#include "core/scene/json.h"

namespace tessera {

// Indented by two; what fits a line stands on one. Numbers that are floats are written with the fewest digits
// that read back as the same float, the others as the same double; -0 keeps its sign. Bytes that are no UTF-8
// become U+FFFD.
std::string json_text(const Json&);

}  // namespace tessera
