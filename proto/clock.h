// SPDX-License-Identifier: Apache-2.0
// The real clock, for the loops and the roads; everything else is told the time.
#pragma once

#include "core/instant.h"

namespace tessera {

inline Instant clock_now() { return std::chrono::time_point_cast<Instant::duration>(Clock::now()); }

}  // namespace tessera
