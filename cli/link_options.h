// SPDX-License-Identifier: Apache-2.0
// Which farm a command speaks to, and how.
#pragma once

#include <string>

#include "cli/endpoint.h"
#include "proto/key_files.h"

namespace tessera {

struct LinkOptions {
  std::string coordinator{kFarmAddress};
  double timeout = 30;  // seconds
  KeyFiles keys;
};

}  // namespace tessera
