// SPDX-License-Identifier: Apache-2.0
// What the subcommands that write pictures say alike on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include <string>
#include <string_view>

namespace tessera {

// --compression of the EXR, --exposure of the preview.
void add_picture_options(CLI::App&, std::string& compression, double& exposure);

// Throws Error(bad_usage).
[[noreturn]] void refuse_option(std::string_view option, std::string_view value, std::string_view accepted);

}  // namespace tessera
