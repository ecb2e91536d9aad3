// SPDX-License-Identifier: Apache-2.0
// --limit NAME=VALUE: how much a scene may ask for.
#pragma once

#include <CLI/CLI.hpp>

#include "core/scene/limits.h"

namespace tessera {

// Adds the option, which may be given again and again. `limits` outlives the parsing. A wrong name or value
// throws Error(bad_usage) with the accepted ones.
void add_limit_option(CLI::App&, ImportLimits& limits);

// "vertices=2M": a whole number, which k, M or G multiply by 1000, and Ki, Mi or Gi by 1024, once to thrice.
void parse_limit(const std::string& text, ImportLimits&);

}  // namespace tessera
