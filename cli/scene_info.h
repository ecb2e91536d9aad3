// SPDX-License-Identifier: Apache-2.0
// What `tessera scene info` prints.
#pragma once

#include <string>

#include "core/scene/scene.h"

namespace tessera {

std::string info_table(const Scene&);
std::string info_json(const Scene&);

}  // namespace tessera
