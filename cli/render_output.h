// SPDX-License-Identifier: Apache-2.0
// What a rendered frame leaves behind besides its files: a line on what was achieved, an exit code.
#pragma once

#include <filesystem>
#include <string>

#include "cli/render_options.h"
#include "coordinator/coordinator.h"
#include "core/error.h"
#include "core/scene/scene.h"

namespace tessera {

// On standard output.
void summarise(const Job&, const JobReport&, const std::filesystem::path& file);

ExitCode exit_code(const Job&, const JobReport&);

// What the scene was made from is not to be written over: throws Error(bad_usage) if `file`, or the preview
// beside it, is one of the scene's own.
void require_foreign(const std::filesystem::path& file, const RenderOptions&, const Scene&);

}  // namespace tessera
