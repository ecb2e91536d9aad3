// SPDX-License-Identifier: Apache-2.0
// What the subcommands that log say alike on the command line.
#pragma once

#include <CLI/CLI.hpp>

#include <string>

namespace tessera {

struct LogOptions {
  std::string level = "warning";
  std::string format = "text";  // or json: an object a line
  bool verbose = false;         // same as level info
};

void add_log_options(CLI::App&, LogOptions&);

// From here on the default logger writes one line an event to stderr: UTC, level, message. "component:
// message", one word before the colon, is two fields of a JSON object.
void set_up_log(const LogOptions&);

}  // namespace tessera
