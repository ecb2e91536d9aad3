// SPDX-License-Identifier: Apache-2.0
// Questions whose answers wait until there is something new to say, so that nobody has to ask again and
// again.
#pragma once

#include <functional>
#include <map>
#include <optional>
#include <vector>

#include "core/instant.h"
#include "proto/message.h"
#include "proto/transport.h"

namespace tessera {

// Less than a client waits before it asks again (ClientOptions::first_pause).
inline constexpr Millis kHold{400};

struct HeldQuestion {
  Peer from;
  Ask ask;
  Identity who;
  Instant until;  // then it is answered in any case
};

class HeldQuestions {
 public:
  // One for each peer: it has given up the one before, or asks it again.
  void hold(HeldQuestion question);

  // Something has changed.
  void news() { news_ = true; }

  // When due() is to be asked next; none: not before there are news.
  std::optional<Instant> next(Instant now) const;

  // Takes out those whose time has come and, if there were news, those that `may_wait` no longer.
  std::vector<HeldQuestion> due(Instant now, const std::function<bool(const Question&)>& may_wait);

 private:
  std::map<Peer, HeldQuestion> held_;
  bool news_ = false;
};

}  // namespace tessera
