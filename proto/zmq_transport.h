// SPDX-License-Identifier: Apache-2.0
// The road over ZeroMQ: inproc://, ipc:// and tcp://. A coordinator is a ROUTER that listens, a worker or a
// command a DEALER that puts its id in front of all it says. With keys everything that is not of this process
// travels under CURVE (encrypted, both ends proven); there is no way back to plain text. Mail that is no
// message, or from somebody who may not say it, is counted and dropped, so nothing a peer sends can stop a
// receive(). Only proto/zmq_* and proto/keys see ZeroMQ.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "proto/codec.h"
#include "proto/gate.h"
#include "proto/key_files.h"
#include "proto/transport.h"

namespace tessera {

// Share one among all transports that meet over inproc://; at most one ZmqRouter with keys in each. Must
// outlive them.
class ZmqContext {
 public:
  explicit ZmqContext(int io_threads = 1);
  ~ZmqContext();
  struct Inside;
  Inside& inside() { return *inside_; }

 private:
  std::unique_ptr<Inside> inside_;
};

struct ZmqOptions {
  // Messages that may wait for one peer; more are lost. The bytes are bounded by the leases of a worker,
  // since pixels are only sent with an Assign, and by the time (a minute) after which a dead connection is
  // dropped.
  int high_water = 1024;
  std::size_t max_part_bytes = kMaxPixelBytes;
  Millis dead{60'000};     // without a sign of life; longer than the largest part takes
  Millis linger{250};      // how long a worker's last words may take to leave after it has gone
  GateLimits limits = {};  // of a router
  // Called in receive() for mail that was dropped, and for peers that were not let in, with the reason.
  std::function<void(std::string_view)> on_dropped = {};
};

struct RouterCounts {
  std::uint64_t received = 0, received_bytes = 0;  // messages passed on
  std::uint64_t alien = 0;                         // dropped: no message of ours
  std::uint64_t bad_id = 0;                        // dropped: the id it came with is none
  std::uint64_t unknown_key = 0;                   // dropped: the key is not allowed any more
  std::uint64_t no_right = 0;                      // dropped: the key's role may not say it
  std::uint64_t too_large = 0;                     // dropped: for the key's role
  std::uint64_t too_fast = 0;                      // dropped: beyond the rate of a connection
  std::uint64_t unsent = 0;                        // to peers: no memory
  // Connections made over a wire, and those of them that were let in: what is missing was refused, or is
  // about to be. Why, where ZeroMQ says so:
  std::uint64_t connections = 0, let_in = 0;
  std::uint64_t refused_keys = 0;        // connections refused: their key is not on the allow-list
  std::uint64_t refused_handshakes = 0;  // connections refused: no CURVE, another server key, damaged, noise
};

class ZmqSocket;  // the part that both ends share
class ZmqEntrance;
class ZmqMonitor;

class ZmqRouter : public Transport {
 public:
  // Throws Error(unreachable) if it cannot listen; without keys Error(bad_usage) for a tcp address beyond
  // loopback: there peers could not be told apart.
  ZmqRouter(ZmqContext&, const std::vector<std::string>& endpoints, ZmqOptions options = {},
            std::optional<ServerKeys> keys = {});
  ~ZmqRouter() override;
  void send(const Peer& to, Message message) override;
  // Mail::from is the peer's id, behind "name/" of its key if it has one. Mail::who is as the allow-list says
  // now.
  std::optional<Mail> receive(Instant until) override;
  void wake() override;

  // From the next receive() on. Peers whose key is not on the list any more are neither heard nor spoken to.
  // Another key pair means that all connections are made anew, by peers that know the new public key.
  // Precondition: it was given keys when it was made. Any thread.
  void reload(ServerKeys keys);

  // What it listens on, with wildcards resolved: "tcp://127.0.0.1:*" becomes the port it got.
  const std::vector<std::string>& endpoints() const { return endpoints_; }
  RouterCounts counts() const;    // any thread
  std::uint64_t dropped() const;  // mail, for whatever reason; any thread

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
  std::vector<std::string> endpoints_;
};

class ZmqDealer : public Transport {
 public:
  // Connects, and reconnects for ever, also if it is refused. Precondition: is_worker_id(id). Throws
  // Error(bad_usage) for an endpoint that is none, and for one beyond this machine without keys.
  ZmqDealer(ZmqContext&, const std::string& endpoint, const WorkerId& id, ZmqOptions options = {},
            std::optional<ClientKeys> keys = {});
  ~ZmqDealer() override;
  void send(const Peer& to, Message message) override;  // there is only one to send to
  std::optional<Mail> receive(Instant until) override;
  void wake() override;

  // Waits for the connection: what is sent before is dropped. False: it is not there. Precondition: nothing
  // was received yet.
  bool await(Instant until);
  // From the next receive() on, over a new connection. Precondition: it was given keys when it was made. Any
  // thread.
  void reload(ClientKeys keys);

  // Why the coordinator does not let it in, for people; empty as long as that is not known. Any thread.
  std::string refusal() const;
  std::uint64_t dropped() const;

 private:
  struct Inside;
  std::unique_ptr<Inside> inside_;
};

}  // namespace tessera
