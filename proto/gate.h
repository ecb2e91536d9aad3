// SPDX-License-Identifier: Apache-2.0
// Who may come through to a coordinator, before a byte of what they say is parsed: the key of a connection,
// the id it claims, the size and the rate of what it sends. Pure: no sockets, time as an argument.
//
// A worker chooses its id, so an id proves nothing. Behind a key an id is only good under the key's name
// ("rack1/worker-7"): whoever says the same id under another name is another peer. What is sent to a peer
// goes to the connection over which it last spoke, and never to one that another name speaks over.
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <variant>

#include "proto/allow_list.h"
#include "proto/codec.h"
#include "proto/rate_limit.h"
#include "proto/recent.h"

namespace tessera {

struct GateLimits {
  RateLimit worker = {};
  RateLimit client = {.messages = 5000, .bytes = 1e9, .message_burst = 20'000, .byte_burst = 2e9};
  std::size_t client_bytes = kMaxHeaderBytes;  // of a message; workers send pixels too
  std::size_t connections = 1 << 16;  // remembered; those not heard of for longest are forgotten first
};

enum class Refusal : std::uint8_t { bad_id, unknown_key, too_large, too_fast };
std::string_view text(Refusal);

// A message as it arrives.
struct Caller {
  std::string_view connection;          // a name that no other connection has
  std::optional<std::string_view> key;  // public key it has proven to hold; nothing: from within this process
  std::string_view id;                  // claimed
  std::size_t bytes = 0;
};

struct Admitted {
  Peer peer;
  Identity who;
};

class Gate {
 public:
  // Without a list everybody is local; with one only those from within this process.
  Gate(const GateLimits&, std::optional<AllowList>);

  // From now on. Precondition: there was a list before.
  void allow(AllowList);
  const std::optional<AllowList>& allowed() const { return allowed_; }

  std::variant<Admitted, Refusal> admit(const Caller&, Instant now);
  // The connection a peer speaks over; nothing for one that is not known or whose key is not allowed any
  // more.
  std::optional<std::string> way_to(const Peer&);

 private:
  struct Connection {
    RateMeter meter;
    bool heard = false;
  };
  // Turned to another connection when that is heard for the first time, or when its own has been silent: late
  // words that came over an old connection do not turn it back.
  struct Way {
    std::string connection, key;
    Instant heard{};
  };
  std::optional<Identity> identity(const Caller&) const;
  void turn(const Peer&, const Caller&, bool first, Instant now);

  GateLimits limits_;
  std::optional<AllowList> allowed_;
  Recent<Connection> connections_;
  Recent<Way> ways_;
};

}  // namespace tessera
