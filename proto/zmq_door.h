// SPDX-License-Identifier: Apache-2.0
// The two places where ZeroMQ says who wants to connect: ZAP (RFC 27), where it asks whether a key may come
// in, and the monitor, where it tells what became of handshakes. Not for use outside proto/zmq_*.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <zmq.hpp>

namespace tessera {

inline constexpr const char* kZapDomain = "tessera";

// One in each context: from when it is made every CURVE handshake in it waits for answer().
class ZmqDoor {
 public:
  explicit ZmqDoor(zmq::context_t&);  // throws Error(internal_error) if there is one already

  // Answers all requests that wait. CURVE keys for which `knows` is true come in, with the key itself as the
  // User-Id of their messages; everything else is refused with 400 and reported.
  void answer(const std::function<bool(std::string_view key)>& knows,
              const std::function<void(std::string_view why)>& refused);
  zmq::socket_t& socket() { return socket_; }

 private:
  zmq::socket_t socket_;
};

struct Handshake {
  enum class End : std::uint8_t {
    accepted,  // nothing yet: somebody has connected
    good,
    unknown_key,   // the other end knows the key of this one not
    no_agreement,  // one end has keys and the other has none
    broken         // broke off: a wrong server key, damage, noise
  };
  End end = End::accepted;
};

// To be destroyed before the socket that it watches.
class ZmqMonitor {
 public:
  ZmqMonitor(zmq::context_t&, zmq::socket_t& watched);
  ~ZmqMonitor();
  ZmqMonitor(const ZmqMonitor&) = delete;
  ZmqMonitor& operator=(const ZmqMonitor&) = delete;

  std::optional<Handshake> next();  // without waiting
  zmq::socket_t& socket() { return socket_; }

 private:
  zmq::socket_t& watched_;
  zmq::socket_t socket_;
};

}  // namespace tessera
