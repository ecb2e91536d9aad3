// SPDX-License-Identifier: Apache-2.0
// Which exit code tells of several frames.
#pragma once

#include "core/error.h"

namespace tessera {

// An interruption tells more than a failure, that more than a limit; of two failures the first one stays.
inline ExitCode worse(ExitCode so_far, ExitCode next) {
  const auto rank = [](ExitCode c) {
    return c == ExitCode::interrupted ? 3 : c == ExitCode::stopped_at_limit ? 1 : c == ExitCode::done ? 0 : 2;
  };
  return rank(next) > rank(so_far) ? next : so_far;
}

}  // namespace tessera
