// SPDX-License-Identifier: Apache-2.0
// Structured noise (Schied et al. 2017, figure 9 and equation 6): a pattern of which a sample is 0 with
// probability alpha and else the pattern over 1 - alpha, alpha rising from left to right. What variance over
// the frames knows and variance over the neighbours does not.
#pragma once

#include <filesystem>
#include <string>

#include "worker/denoise/device.h"

namespace tessera::temporal {

// Filters `frames` frames of the pattern; writes structured.png into `folder` and returns a table in
// Markdown.
std::string structured(Device&, int frames, const std::filesystem::path& folder);

}  // namespace tessera::temporal
