// SPDX-License-Identifier: Apache-2.0
// The real clocks, for the loops and the roads; everything else is told the time.
#pragma once

#include <cstdint>

#include "core/instant.h"

namespace tessera {

inline Instant clock_now() { return std::chrono::time_point_cast<Instant::duration>(Clock::now()); }

// Milliseconds since 1970, which may jump: for people to read, never to decide by.
inline std::int64_t unix_ms() {
  return std::chrono::duration_cast<std::chrono::milliseconds>(
             std::chrono::system_clock::now().time_since_epoch())
      .count();
}

}  // namespace tessera
