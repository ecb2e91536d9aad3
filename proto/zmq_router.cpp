// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <array>
#include <atomic>
#include <cassert>
#include <mutex>

#include "proto/clock.h"
#include "proto/rights.h"
#include "proto/zmq_door.h"
#include "proto/zmq_socket.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

constexpr std::size_t kFrontParts = 2;  // the connection, the sender's id
constexpr int kPatience = 4096;         // dropped messages in one receive() before the time is looked at
constexpr Millis kTryAgain{5};          // to listen where ZeroMQ has not let go of the port yet
constexpr RateLimit kReports{.messages = 10, .message_burst = 20, .pause = Millis{1000}};

std::optional<std::string_view> property(zmq::message_t& part, const char* name) {
  const char* value = zmq_msg_gets(part.handle(), name);
  return value ? std::optional<std::string_view>(value) : std::nullopt;
}

// The key that ZAP put on a message. What came over no wire has neither key nor socket type; what came over a
// wire and has no key has a key that nobody knows.
std::optional<std::string_view> key_of(zmq::message_t& part) {
  const auto key = property(part, "User-Id");
  return key || !property(part, "Socket-Type") ? key : std::optional<std::string_view>("");
}

enum Count : std::size_t {
  received,
  received_bytes,
  alien,
  bad_id,
  unknown_key,
  no_right,
  too_large,
  too_fast,
  unsent,
  connections,
  let_in,
  refused_keys,
  refused_handshakes,
  kCounts
};

Count count_of(Refusal refusal) {
  switch (refusal) {
    case Refusal::bad_id:
      return bad_id;
    case Refusal::unknown_key:
      return unknown_key;
    case Refusal::too_large:
      return too_large;
    case Refusal::too_fast:
      return too_fast;
  }
  return alien;
}

}  // namespace

struct ZmqRouter::Inside {
  Inside(ZmqContext& context, ZmqOptions&& o, std::optional<ServerKeys>&& keys)
      : options(std::move(o)),
        gate(options.limits, keys ? std::optional(keys->allowed) : std::nullopt),
        socket(context, zmq::socket_type::router, options),
        monitor(context.inside().context, socket.socket()) {
    if (!keys) return;
    door.emplace(context.inside().context);
    others.push_back(&door->socket());
    secret = keys->pair.secret_key;
    socket.socket().set(zmq::sockopt::zap_domain, kZapDomain);
    socket.socket().set(zmq::sockopt::curve_server, true);
    socket.socket().set(zmq::sockopt::curve_secretkey, secret);
  }

  void count(Count what, std::uint64_t n = 1) { counts[what].fetch_add(n, std::memory_order_relaxed); }

  void drop(Count why, std::string_view reason) {
    count(why);
    if (options.on_dropped && reports.admit(kReports, 0, clock_now())) options.on_dropped(reason);
  }

  // All that has to be done besides mail.
  void tend(const std::vector<std::string>& endpoints) {
    if (fresh.load(std::memory_order_acquire)) renew(endpoints);
    if (!unbound.empty()) listen_again();
    if (door)
      door->answer([&](std::string_view key) { return gate.allowed()->find(key) != nullptr; },
                   [&](std::string_view why) { drop(refused_keys, why); });
    while (const auto shaken = monitor.next()) note(shaken->end);
  }

  void note(Handshake::End end) {
    switch (end) {
      case Handshake::End::accepted:
        return count(connections);
      case Handshake::End::good:
        return count(let_in);
      case Handshake::End::unknown_key:
        return;  // the door has counted it
      case Handshake::End::no_agreement:
        return drop(refused_handshakes, "a connection: its other end and this one do not both use keys");
      case Handshake::End::broken:
        return drop(refused_handshakes, "a connection: it broke off, or what came over it was damaged");
    }
  }

  void renew(const std::vector<std::string>& endpoints) {
    ServerKeys keys;
    {
      const std::lock_guard lock(mutex);
      keys = std::move(next);
      fresh.store(false, std::memory_order_relaxed);
    }
    gate.allow(std::move(keys.allowed));
    if (keys.pair.secret_key == secret) return;
    secret = keys.pair.secret_key;
    socket.socket().set(zmq::sockopt::curve_secretkey, secret);
    for (const std::string& endpoint : endpoints) {
      if (endpoint.starts_with("inproc:")) continue;
      try {
        socket.socket().unbind(endpoint);
      } catch (const zmq::error_t&) {  // it was not bound (yet)
      }
      unbound.push_back(endpoint);
    }
  }

  void listen_again() {
    std::erase_if(unbound, [&](const std::string& endpoint) {
      return zmq_bind(socket.socket().handle(), endpoint.c_str()) == 0;
    });
  }

  std::optional<Mail> read(ZmqSocket::Parts& taken) {
    if (taken.parts.size() <= kFrontParts) {
      drop(alien, "message: parts: too few");
      return std::nullopt;
    }
    std::size_t bytes = 0;
    for (std::size_t i = kFrontParts; i < taken.parts.size(); ++i) bytes += taken.parts[i].size();
    const auto verdict = gate.admit({.connection = taken.parts[0].to_string_view(),
                                     .key = key_of(taken.parts[kFrontParts]),
                                     .id = taken.parts[1].to_string_view(),
                                     .bytes = bytes},
                                    clock_now());
    if (const auto* refusal = std::get_if<Refusal>(&verdict)) {
      drop(count_of(*refusal), fmt::format("message: {}", text(*refusal)));
      return std::nullopt;
    }
    const Admitted& caller = std::get<Admitted>(verdict);
    try {
      Mail mail{caller.peer, decode_parts(taken, kFrontParts), caller.who};
      if (!may_say(mail.who, mail.message)) {
        drop(no_right, fmt::format("message: {} speaks as a worker and is none", caller.peer));
        return std::nullopt;
      }
      count(received);
      count(received_bytes, bytes);
      return mail;
    } catch (const ProtocolError& error) {
      drop(alien, error.what());
    } catch (const std::bad_alloc&) {
      drop(alien, "no memory for its pixels");
    }
    return std::nullopt;
  }

  bool wait(Instant until) {
    if (unbound.empty()) return socket.wait(until, others);
    const Instant soon = clock_now() + kTryAgain;
    return soon < until ? socket.wait(soon, others) || clock_now() >= soon : socket.wait(until, others);
  }

  ZmqOptions options;
  Gate gate;
  std::optional<ZmqDoor> door;  // outlives the socket, whose handshakes ask it
  ZmqSocket socket;
  ZmqMonitor monitor;
  std::vector<zmq::socket_t*> others{&monitor.socket()};
  std::string secret;
  std::vector<std::string> unbound;  // endpoints to listen on under the new key
  RateMeter reports;                 // a log is not to be flooded by strangers
  std::array<std::atomic<std::uint64_t>, kCounts> counts{};
  std::mutex mutex;  // guards `next`
  ServerKeys next;
  std::atomic<bool> fresh = false;
};

ZmqRouter::ZmqRouter(ZmqContext& context, const std::vector<std::string>& endpoints, ZmqOptions options,
                     std::optional<ServerKeys> keys) {
  const bool closed = keys.has_value();
  inside_ = std::make_unique<Inside>(context, std::move(options), std::move(keys));
  zmq::socket_t& socket = inside_->socket.socket();
  socket.set(zmq::sockopt::backlog, 1024);  // a whole farm that comes back at once
  for (const std::string& endpoint : endpoints) {
    if (!closed && !is_loopback(endpoint))
      throw Error(ExitCode::bad_usage,
                  endpoint +
                      ": listens beyond this machine without keys; accepted: tcp://127.0.0.1, or keys: see "
                      "'tessera keygen --help'");
    try {
      socket.bind(endpoint);
    } catch (const zmq::error_t& error) {
      throw Error(ExitCode::unreachable, fmt::format("cannot listen on {}: {}", endpoint, error.what()));
    }
    endpoints_.push_back(socket.get(zmq::sockopt::last_endpoint));
  }
}

ZmqRouter::~ZmqRouter() = default;

void ZmqRouter::send(const Peer& to, Message message) {
  const auto way = inside_->gate.way_to(to);
  if (!way) return;
  if (const auto why = inside_->socket.send(*way, std::move(message))) inside_->drop(unsent, *why);
}

std::optional<Mail> ZmqRouter::receive(Instant until) {
  for (int dropped = 0;;) {
    inside_->tend(endpoints_);
    if (auto taken = inside_->socket.take(kFrontParts + kMaxParts)) {
      if (auto mail = inside_->read(*taken)) return mail;
      if (++dropped >= kPatience && clock_now() >= until) return std::nullopt;
    } else if (!inside_->wait(until)) {
      return std::nullopt;
    }
  }
}

void ZmqRouter::wake() { inside_->socket.ring(); }

void ZmqRouter::reload(ServerKeys keys) {
  assert(inside_->door);
  {
    const std::lock_guard lock(inside_->mutex);
    inside_->next = std::move(keys);
    inside_->fresh.store(true, std::memory_order_release);
  }
  wake();
}

RouterCounts ZmqRouter::counts() const {
  const auto of = [&](Count what) { return inside_->counts[what].load(std::memory_order_relaxed); };
  return {.received = of(received),
          .received_bytes = of(received_bytes),
          .alien = of(alien),
          .bad_id = of(bad_id),
          .unknown_key = of(unknown_key),
          .no_right = of(no_right),
          .too_large = of(too_large),
          .too_fast = of(too_fast),
          .unsent = of(unsent),
          .connections = of(connections),
          .let_in = of(let_in),
          .refused_keys = of(refused_keys),
          .refused_handshakes = of(refused_handshakes)};
}

std::uint64_t ZmqRouter::dropped() const {
  const RouterCounts c = counts();
  return c.alien + c.bad_id + c.unknown_key + c.no_right + c.too_large + c.too_fast + c.unsent;
}

}  // namespace tessera
