// SPDX-License-Identifier: Apache-2.0
// The road over ZeroMQ: inproc://, ipc:// and tcp://. A coordinator is a ROUTER that listens, a worker a
// DEALER whose routing id is its WorkerId. Mail that is no message is counted and dropped, so nothing a peer
// sends can stop a receive(). The only file pair that sees ZeroMQ.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "proto/codec.h"
#include "proto/transport.h"

namespace tessera {

// Share one among all transports that meet over inproc://. Must outlive them.
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
  Millis linger{250};  // how long a worker's last words may take to leave after it has gone
  // Called in receive() for mail that was dropped, with the reason.
  std::function<void(std::string_view)> on_dropped = {};
};

class ZmqSocket;  // the part that both ends share

class ZmqRouter : public Transport {
 public:
  // Throws Error(unreachable) if it cannot listen, Error(bad_usage) for a tcp address beyond loopback: the
  // farm is closed as long as peers cannot be told apart by keys.
  ZmqRouter(ZmqContext&, const std::vector<std::string>& endpoints, ZmqOptions options = {});
  ~ZmqRouter() override;
  void send(const Peer& to, Message message) override;
  std::optional<Mail> receive(Instant until) override;
  void wake() override;

  // What it listens on, with wildcards resolved: "tcp://127.0.0.1:*" becomes the port it got.
  const std::vector<std::string>& endpoints() const { return endpoints_; }
  std::uint64_t dropped() const;

 private:
  std::unique_ptr<ZmqSocket> socket_;
  std::vector<std::string> endpoints_;
};

class ZmqDealer : public Transport {
 public:
  // Connects, and reconnects for ever. Precondition: is_worker_id(id). Throws Error(bad_usage) for an
  // endpoint that is none.
  ZmqDealer(ZmqContext&, const std::string& endpoint, const WorkerId& id, ZmqOptions options = {});
  ~ZmqDealer() override;
  void send(const Peer& to, Message message) override;  // there is only one to send to
  std::optional<Mail> receive(Instant until) override;
  void wake() override;
  std::uint64_t dropped() const;

 private:
  std::unique_ptr<ZmqSocket> socket_;
};

}  // namespace tessera
