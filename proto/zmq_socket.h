// SPDX-License-Identifier: Apache-2.0
// What both ends of a ZeroMQ road share: whole messages out, whole messages in, and waiting for them. Not for
// use outside proto/zmq_*.
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>
#include <zmq.hpp>

#include "proto/codec.h"
#include "proto/zmq_transport.h"

namespace tessera {

struct ZmqContext::Inside {
  explicit Inside(int io_threads) : context(io_threads) {}
  zmq::context_t context;
};

// ZeroMQ hands messages from thread to thread in ways that ThreadSanitizer does not see, so it is told.
void tell_sanitizer_of_handover(bool giving);

// True if nothing but this machine can reach an endpoint.
bool is_loopback(std::string_view endpoint);

class ZmqSocket {
 public:
  ZmqSocket(ZmqContext&, zmq::socket_type, const ZmqOptions&);
  ~ZmqSocket();
  ZmqSocket(const ZmqSocket&) = delete;
  ZmqSocket& operator=(const ZmqSocket&) = delete;

  zmq::socket_t& socket() { return socket_; }

  // `front` is the first part: of a ROUTER's message the connection, of a DEALER's its own id. Why it could
  // not be sent, or nothing.
  std::optional<std::string> send(std::string_view front, Message&&);

  // The parts of the next message, without waiting, and how many they were: those beyond `most` are let go.
  // Nothing if there is none.
  struct Parts {
    std::vector<zmq::message_t> parts;
    std::size_t count = 0;
  };
  std::optional<Parts> take(std::size_t most);

  // False at `until`, or when the bell has rung; true if there is something to see to, here or at `others`.
  bool wait(Instant until, std::span<zmq::socket_t* const> others);
  void ring();  // any thread

 private:
  void look_for_life(bool router, Millis dead);

  zmq::socket_t socket_;
  int bell_;  // an eventfd: ring() may come from any thread, a socket may not
};

// A message from its parts behind the first `skip`. Throws ProtocolError.
Message decode_parts(const ZmqSocket::Parts&, std::size_t skip);

}  // namespace tessera
