// SPDX-License-Identifier: Apache-2.0
// How much one connection may send: a bucket that fills at a rate and is emptied by what comes. Pure.
#pragma once

#include <cstddef>

#include "core/instant.h"

namespace tessera {

struct RateLimit {
  double messages = 20'000, bytes = 2e9;              // a second
  double message_burst = 40'000, byte_burst = 4.3e9;  // at once; not below the largest message
  Millis pause{5000};  // how long nothing more is heard of one that went beyond
};

class RateMeter {
 public:
  // True if a message of `bytes` is within the limit at `now`, which does not go back.
  bool admit(const RateLimit&, std::size_t bytes, Instant now);

 private:
  double messages_ = 0, bytes_ = 0;  // spent and not yet made good
  Instant last_{}, deaf_until_{};
};

}  // namespace tessera
