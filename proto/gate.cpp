// SPDX-License-Identifier: Apache-2.0
#include "proto/gate.h"

#include <cassert>
#include <utility>

namespace tessera {
namespace {

constexpr std::chrono::seconds kSilence{1};

}  // namespace

std::string_view text(Refusal refusal) {
  switch (refusal) {
    case Refusal::bad_id:
      return "its id is not 1 to 64 printable characters";
    case Refusal::unknown_key:
      return "its key is not on the allow-list";
    case Refusal::too_large:
      return "it is larger than its role may send";
    case Refusal::too_fast:
      return "its connection sends more than it may";
  }
  return {};
}

Gate::Gate(const GateLimits& limits, std::optional<AllowList> allowed)
    : limits_(limits),
      allowed_(std::move(allowed)),
      connections_(limits.connections),
      ways_(limits.connections) {}

void Gate::allow(AllowList list) {
  assert(allowed_);
  allowed_ = std::move(list);
}

std::optional<Identity> Gate::identity(const Caller& caller) const {
  if (!allowed_ || !caller.key) return Identity{};
  const Identity* who = allowed_->find(*caller.key);
  return who ? std::optional(*who) : std::nullopt;
}

std::variant<Admitted, Refusal> Gate::admit(const Caller& caller, Instant now) {
  std::optional<Identity> who = identity(caller);
  if (!who) return Refusal::unknown_key;
  Connection& connection = connections_.at(caller.connection);
  if (!connection.meter.admit(who->worker ? limits_.worker : limits_.client, caller.bytes, now))
    return Refusal::too_fast;
  if (!who->worker && caller.bytes > limits_.client_bytes) return Refusal::too_large;
  if (!is_worker_id(caller.id)) return Refusal::bad_id;
  Admitted admitted{allowed_ && caller.key ? who->name + "/" : "", std::move(*who)};
  admitted.peer += caller.id;
  turn(admitted.peer, caller, !std::exchange(connection.heard, true), now);
  return admitted;
}

void Gate::turn(const Peer& peer, const Caller& caller, bool first, Instant now) {
  Way& way = ways_.at(peer);
  if (way.connection != caller.connection) {
    if (!way.connection.empty() && !first && now - way.heard < kSilence) return;
    way.connection = caller.connection;
  }
  way.key = allowed_ && caller.key ? *caller.key : std::string_view();
  way.heard = now;
}

std::optional<std::string> Gate::way_to(const Peer& peer) {
  const Way* way = ways_.find(peer);
  if (!way) return std::nullopt;
  if (!way->key.empty() && !allowed_->find(way->key)) return std::nullopt;
  return way->connection;
}

}  // namespace tessera
