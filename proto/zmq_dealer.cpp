// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <mutex>

#include "proto/clock.h"
#include "proto/zmq_door.h"
#include "proto/zmq_socket.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

constexpr Millis kFirstPause{100}, kLastPause{5000};  // before another try to connect

std::string reason_of(Handshake::End end, bool keys, const std::string& own, const std::string& server) {
  switch (end) {
    case Handshake::End::accepted:
    case Handshake::End::good:
      return {};
    case Handshake::End::unknown_key:
      return fmt::format("the coordinator's allow-list has no line for the key {}", own);
    case Handshake::End::no_agreement:
      return keys ? "the coordinator speaks in plain text: it was started without keys"
                  : "the coordinator lets nobody in without a key: see 'tessera keygen --help'";
    case Handshake::End::broken:
      break;
  }
  return keys ? fmt::format(
                    "the coordinator broke off: its public key is not {}, or it was started without keys",
                    server)
              : "what listens there broke off: it wants keys (see 'tessera keygen --help'), or is no "
                "coordinator";
}

}  // namespace

struct ZmqDealer::Inside {
  Inside(ZmqContext& context, std::string to, WorkerId name, ZmqOptions&& o, std::optional<ClientKeys>&& k)
      : options(std::move(o)),
        endpoint(std::move(to)),
        id(std::move(name)),
        keys(std::move(k)),
        socket(context, zmq::socket_type::dealer, options),
        monitor(context.inside().context, socket.socket()) {
    zmq::socket_t& s = socket.socket();
    // Nothing is kept for a coordinator that is not there: it would be stale when it comes.
    s.set(zmq::sockopt::immediate, true);
    s.set(zmq::sockopt::reconnect_ivl, static_cast<int>(kFirstPause.count()));
    s.set(zmq::sockopt::reconnect_ivl_max, static_cast<int>(kLastPause.count()));
  }

  void connect() {
    zmq::socket_t& s = socket.socket();
    if (keys) {
      s.set(zmq::sockopt::curve_serverkey, keys->servers[server]);
      s.set(zmq::sockopt::curve_publickey, keys->pair.public_key);
      s.set(zmq::sockopt::curve_secretkey, keys->pair.secret_key);
    }
    s.connect(endpoint);
  }

  // ZeroMQ ends some of the connections that were refused for good, others it tries again with the same keys.
  void connect_again() {
    try {
      socket.socket().disconnect(endpoint);
    } catch (const zmq::error_t&) {  // it has ended by itself
    }
    again.reset();
    try {
      connect();
    } catch (const zmq::error_t& error) {  // no descriptors left, for instance
      drop(fmt::format("cannot connect to {}: {}", endpoint, error.what()));
      again = clock_now() + kLastPause;
    }
  }

  void tend() {
    if (fresh.load(std::memory_order_acquire)) {
      const std::lock_guard lock(mutex);
      fresh.store(false, std::memory_order_relaxed);
      if (next != *keys) {
        keys = next;
        server = 0;
        pause = kFirstPause;
        again = clock_now();
      }
    }
    while (const auto shaken = monitor.next()) note(shaken->end);
    if (again && clock_now() >= *again) connect_again();
  }

  void note(Handshake::End end) {
    const std::string reason = reason_of(end, keys.has_value(), keys ? keys->pair.public_key : "",
                                         keys ? keys->servers[server] : "");
    {
      const std::lock_guard lock(mutex);
      refusal = reason;
    }
    if (end == Handshake::End::good) {
      pause = kFirstPause;
      again.reset();
      met = true;
    } else if (!again) {
      if (keys && end == Handshake::End::broken) server = (server + 1) % keys->servers.size();
      again = clock_now() + pause;
      pause = std::min(pause * 2, kLastPause);
      drop(reason);
    }
  }

  std::optional<Mail> read(const ZmqSocket::Parts& taken) {
    try {
      return Mail{.from = "coordinator", .message = decode_parts(taken, 0)};
    } catch (const ProtocolError& error) {
      drop(error.what());
    } catch (const std::bad_alloc&) {
      drop("no memory for its pixels");
    }
    dropped.fetch_add(1, std::memory_order_relaxed);
    return std::nullopt;
  }

  void drop(std::string_view reason) {
    if (options.on_dropped) options.on_dropped(reason);
  }

  bool wait(Instant until) {
    zmq::socket_t* const others[] = {&monitor.socket()};
    if (!again || *again >= until) return socket.wait(until, others);
    return socket.wait(*again, others) || clock_now() >= *again;
  }

  ZmqOptions options;
  std::string endpoint;
  WorkerId id;
  std::optional<ClientKeys> keys;
  std::size_t server = 0;  // the key of keys->servers that is tried
  ZmqSocket socket;
  ZmqMonitor monitor;
  bool met = false;              // the coordinator, once
  std::optional<Instant> again;  // when to connect again
  Millis pause = kFirstPause;
  std::atomic<std::uint64_t> dropped = 0;
  std::mutex mutex;  // guards the next two
  ClientKeys next;
  std::string refusal;
  std::atomic<bool> fresh = false;
};

ZmqDealer::ZmqDealer(ZmqContext& context, const std::string& endpoint, const WorkerId& id, ZmqOptions options,
                     std::optional<ClientKeys> keys) {
  assert(is_worker_id(id));
  assert(!keys || !keys->servers.empty());
  if (!keys && !is_loopback(endpoint))
    throw Error(ExitCode::bad_usage,
                endpoint +
                    ": is beyond this machine, and there are no keys: nothing is sent in plain text; "
                    "accepted: tcp://127.0.0.1, or keys: see 'tessera keygen --help'");
  inside_ = std::make_unique<Inside>(context, endpoint, id, std::move(options), std::move(keys));
  try {
    inside_->connect();
  } catch (const zmq::error_t& error) {
    throw Error(ExitCode::bad_usage, fmt::format("cannot connect to {}: {}", endpoint, error.what()));
  }
}

ZmqDealer::~ZmqDealer() = default;

void ZmqDealer::send(const Peer&, Message message) {
  if (const auto why = inside_->socket.send(inside_->id, std::move(message))) inside_->drop(*why);
}

std::optional<Mail> ZmqDealer::receive(Instant until) {
  for (;;) {
    inside_->tend();
    if (auto taken = inside_->socket.take(kMaxParts)) {
      if (auto mail = inside_->read(*taken)) return mail;
    } else if (!inside_->wait(until)) {
      return std::nullopt;
    }
  }
}

bool ZmqDealer::await(Instant until) {
  for (;;) {
    inside_->tend();
    if (inside_->met || clock_now() >= until) return inside_->met;
    inside_->wait(until);
  }
}

void ZmqDealer::wake() { inside_->socket.ring(); }

void ZmqDealer::reload(ClientKeys keys) {
  assert(inside_->keys && !keys.servers.empty());
  {
    const std::lock_guard lock(inside_->mutex);
    inside_->next = std::move(keys);
    inside_->fresh.store(true, std::memory_order_release);
  }
  wake();
}

std::string ZmqDealer::refusal() const {
  const std::lock_guard lock(inside_->mutex);
  return inside_->refusal;
}

std::uint64_t ZmqDealer::dropped() const { return inside_->dropped.load(std::memory_order_relaxed); }

}  // namespace tessera
