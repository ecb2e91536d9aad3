// SPDX-License-Identifier: Apache-2.0
// What the subcommands of a farm say alike about keys: --key, --allow, --server-key, and in the environment
// TESSERA_KEY, TESSERA_ALLOW, TESSERA_SERVER_KEY.
#pragma once

#include <CLI/CLI.hpp>

#include "proto/key_files.h"

namespace tessera {

// Of a coordinator. `files` outlives the parsing; read_server_keys() is what to do with it then.
void add_server_key_options(CLI::App&, KeyFiles& files);
// Of a worker or a command; read_client_keys().
void add_client_key_options(CLI::App&, KeyFiles& files);

}  // namespace tessera
