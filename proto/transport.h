// SPDX-License-Identifier: Apache-2.0
// The road between coordinator and workers: whole messages to and from named peers. It may lose, delay,
// repeat and reorder; nothing above relies on more. One thread sends and receives; any thread may wake().
#pragma once

#include <optional>
#include <string>

#include "core/instant.h"
#include "proto/message.h"

namespace tessera {

using Peer = std::string;  // a worker's id; the coordinator is "coordinator"

// What a peer may do, by the key it came with. On roads that are of this machine alone everybody may do all.
struct Identity {
  std::string name = "local";  // of the key, for logs and as the owner of what it submits
  bool worker = true, submitter = true, administrator = true;
  bool operator==(const Identity&) const = default;
};

struct Mail {
  Peer from;
  Message message;
  Identity who = {};
};

class Transport {
 public:
  virtual ~Transport() = default;
  // Never blocks; a message to nobody is lost.
  virtual void send(const Peer& to, Message message) = 0;
  // The next message, or nothing at `until` or after wake().
  virtual std::optional<Mail> receive(Instant until) = 0;
  // Makes a receive() that waits, or the next one, return at once.
  virtual void wake() = 0;
};

}  // namespace tessera
