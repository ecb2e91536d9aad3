// SPDX-License-Identifier: Apache-2.0
// Time as an argument. Only the loops and main read a clock.
#pragma once

#include <chrono>

namespace tessera {

using Millis = std::chrono::milliseconds;
using Clock = std::chrono::steady_clock;
using Instant = std::chrono::time_point<Clock, std::chrono::microseconds>;

inline double seconds_between(Instant from, Instant to) {
  return std::chrono::duration<double>(to - from).count();
}

}  // namespace tessera
