// SPDX-License-Identifier: Apache-2.0
// Configuration files: options by their long names, as TOML: `listen = "0.0.0.0:7711"`. What the command line
// or the environment says goes before.
#pragma once

#include <CLI/CLI.hpp>

#include <filesystem>

namespace tessera {

// Reads the file into the environment variables of the subcommand's options, where they are not set. Throws
// InputError that names the file, and the option it does not know or that cannot be configured.
void read_config(const std::filesystem::path& file, const CLI::App& subcommand);

// The file that the command line, or else TESSERA_CONFIG, names; empty: none.
std::filesystem::path config_file(int argc, char** argv);

}  // namespace tessera
