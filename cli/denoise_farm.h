// SPDX-License-Identifier: Apache-2.0
// `tessera denoise` through a farm: what the filter takes is gathered here and handed in, and what comes of
// it is written here.
#pragma once

#include "cli/denoise.h"
#include "cli/denoise_words.h"
#include "cli/noisy_files.h"
#include "core/error.h"

namespace tessera {

// The same files as on this machine, to the bit. Returns what the command ends with. Throws what the farm
// denies, Error(unreachable), and Error(bad_usage) for options that are none of a farm's.
ExitCode denoise_on_farm(const DenoiseOptions&, const NoisyFiles&, DenoiseWords&);

}  // namespace tessera
