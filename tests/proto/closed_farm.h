// SPDX-License-Identifier: Apache-2.0
// For tests of roads with keys: keys, lists of them, and waiting for something to happen on a road.
#pragma once

#include <gtest/gtest.h>

#include <fmt/format.h>

#include <functional>
#include <string>
#include <vector>

#include "proto/clock.h"
#include "proto/zmq_transport.h"

namespace tessera {

inline AllowList allow(const std::vector<std::pair<std::string, KeyPair>>& lines) {
  std::string text;
  for (const auto& [roles_and_name, pair] : lines) text += roles_and_name + " " + pair.public_key + "\n";
  return parse_allow_list(text, "test");
}

// A coordinator with keys, and what it has heard.
class ClosedFarm {
 public:
  explicit ClosedFarm(const std::vector<std::pair<std::string, KeyPair>>& lines, ZmqOptions options = {},
                      const std::string& endpoint = "tcp://127.0.0.1:*")
      : router(context, {endpoint}, std::move(options), ServerKeys{server, allow(lines)}) {}

  std::string endpoint() const { return router.endpoints()[0]; }
  int port() const { return std::stoi(endpoint().substr(endpoint().rfind(':') + 1)); }
  std::unique_ptr<ZmqDealer> dealer(const KeyPair& pair, const WorkerId& id = "worker-1") {
    return std::make_unique<ZmqDealer>(others, endpoint(), id, ZmqOptions{},
                                       ClientKeys{pair, {server.public_key}});
  }
  void reload(const std::vector<std::pair<std::string, KeyPair>>& lines) {
    router.reload({server, allow(lines)});
    hear();
  }

  // Takes what there is to take.
  void hear(Millis patience = Millis{5}) {
    while (auto mail = router.receive(clock_now() + patience)) mails.push_back(std::move(*mail));
  }
  // Listens until something is so; false if that takes too long.
  bool until(const std::function<bool()>& so) {
    for (const Instant end = clock_now() + std::chrono::seconds{30}; clock_now() < end; hear())
      if (so()) return true;
    return so();
  }
  // The same, and one more says NeedJob{number} all the while, and listens.
  bool says(ZmqDealer& dealer, JobId number) {
    return until([&] {
      for (const Mail& mail : mails)
        if (const auto* said = std::get_if<NeedJob>(&mail.message); said && said->id == number) return true;
      dealer.send("coordinator", NeedJob{number});
      dealer.receive(clock_now());
      return false;
    });
  }

  KeyPair server = make_key_pair();
  ZmqContext context, others;  // others: as if in another process
  ZmqRouter router;
  std::vector<Mail> mails;
};

}  // namespace tessera
