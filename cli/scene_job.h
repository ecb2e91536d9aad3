// SPDX-License-Identifier: Apache-2.0
// From a scene and what the command line says of it to all that a farm needs to know; local or not.
#pragma once

#include "cli/render_options.h"
#include "core/scene/scene.h"
#include "core/submission.h"

namespace tessera {

// Logs the scene's warnings. Throws InputError if it has no such camera or variant.
void check_choices(const RenderOptions&, const Scene&);

// The frames that the options ask for. Its scene is where the options say, on this machine.
Submission submission_of(const RenderOptions&, const Scene&);

}  // namespace tessera
