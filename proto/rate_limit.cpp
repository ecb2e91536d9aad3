// SPDX-License-Identifier: Apache-2.0
#include "proto/rate_limit.h"

#include <algorithm>

namespace tessera {

bool RateMeter::admit(const RateLimit& limit, std::size_t bytes, Instant now) {
  if (now < deaf_until_) return false;
  const double seconds = seconds_between(last_, now);
  last_ = now;
  messages_ = std::max(0.0, messages_ - seconds * limit.messages);
  bytes_ = std::max(0.0, bytes_ - seconds * limit.bytes);
  const auto size = static_cast<double>(bytes);
  if (messages_ + 1 > limit.message_burst || bytes_ + size > limit.byte_burst) {
    deaf_until_ = now + limit.pause;
    return false;
  }
  messages_ += 1;
  bytes_ += size;
  return true;
}

}  // namespace tessera
