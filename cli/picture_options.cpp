// SPDX-License-Identifier: Apache-2.0
#include "cli/picture_options.h"

#include <fmt/format.h>

#include "core/error.h"
#include "core/exr.h"

namespace tessera {

void add_picture_options(CLI::App& app, std::string& compression, double& exposure) {
  app.add_option("--compression", compression, "Of the EXR")
      ->check(CLI::IsMember(exr_compressions()))
      ->envname("TESSERA_COMPRESSION")
      ->capture_default_str();
  app.add_option("--exposure", exposure, "Stops, of the PNG preview only")
      ->check(CLI::Range(-100.0, 100.0))
      ->capture_default_str();
}

void refuse_option(std::string_view option, std::string_view value, std::string_view accepted) {
  throw Error(ExitCode::bad_usage,
              fmt::format("{}: '{}' is not accepted; accepted: {}", option, value, accepted));
}

}  // namespace tessera
