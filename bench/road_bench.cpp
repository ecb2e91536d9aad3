// SPDX-License-Identifier: Apache-2.0
// What keys cost on the road between machines: messages and pixels a second through one coordinator's socket,
// and connections made a second, with CURVE and without.
#include <fmt/format.h>

#include <atomic>
#include <thread>

#include "proto/clock.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

constexpr int kPeers = 8;

double seconds_since(Instant begin) { return seconds_between(begin, clock_now()); }

struct Farm {
  explicit Farm(bool closed) {
    if (!closed) return;
    keys = ServerKeys{make_key_pair(), parse_allow_list("worker bench " + peer.public_key, "bench")};
  }
  std::unique_ptr<ZmqDealer> dealer(int number) {
    std::optional<ClientKeys> client;
    if (keys) client = ClientKeys{peer, {keys->pair.public_key}};
    return std::make_unique<ZmqDealer>(others, router->endpoints()[0], fmt::format("peer-{}", number),
                                       ZmqOptions{}, client);
  }
  KeyPair peer = make_key_pair();
  std::optional<ServerKeys> keys;
  ZmqContext context, others;
  std::unique_ptr<ZmqRouter> router;
};

std::unique_ptr<Farm> farm(bool closed) {
  auto made = std::make_unique<Farm>(closed);
  ZmqOptions options;
  options.limits.worker = {.messages = 1e9, .bytes = 1e12, .message_burst = 1e9, .byte_burst = 1e12};
  made->router = std::make_unique<ZmqRouter>(made->context, std::vector<std::string>{"tcp://127.0.0.1:*"},
                                             options, made->keys);
  return made;
}

// Peers ask and wait for the answer, each with `ahead` questions under way; messages taken in a second.
double round_trips(bool closed, int ahead, const Message& question, const Message& answer) {
  const auto made = farm(closed);
  std::atomic<bool> end = false;
  std::vector<std::jthread> threads;
  for (int n = 0; n < kPeers; ++n)
    threads.emplace_back([&, n] {
      const auto dealer = made->dealer(n);
      while (!end) {
        for (int i = 0; i < ahead; ++i) dealer->send("coordinator", question);
        for (int i = 0; i < ahead && !end; ++i)
          if (!dealer->receive(clock_now() + Millis{200})) break;
      }
    });
  const auto serve = [&](double seconds) {
    int count = 0;
    for (const Instant begin = clock_now(); seconds_since(begin) < seconds;)
      if (auto mail = made->router->receive(clock_now() + Millis{10})) {
        made->router->send(mail->from, answer);
        ++count;
      }
    return count / seconds;
  };
  serve(1);
  const double rate = serve(3);
  end = true;
  return rate;
}

double connections(bool closed) {
  const auto made = farm(closed);
  const Instant begin = clock_now();
  int count = 0;
  for (; seconds_since(begin) < 3; ++count) {
    const auto dealer = made->dealer(count);
    do dealer->send("coordinator", Goodbye{});
    while (!made->router->receive(clock_now() + Millis{1}));
  }
  return count / seconds_since(begin);
}

int run() {
  const Message small = Heartbeat{{{1, 1}, {2, 1}}};
  const Message pixels = RenderDone{1, 1, {{0, 8}, Image({0, 0, 256, 256}, 8)}};
  fmt::print("{} peers and a coordinator on this machine, over TCP\n", kPeers);
  fmt::print("{:42} {:>12} {:>12} {:>8}\n", "", "plain", "CURVE", "ratio");
  const auto row = [](const char* what, double plain, double closed) {
    fmt::print("{:42} {:12.0f} {:12.0f} {:8.2f}\n", what, plain, closed, closed / plain);
  };
  row("small messages/s, 16 under way each", round_trips(false, 16, small, NeedJob{1}),
      round_trips(true, 16, small, NeedJob{1}));
  row("small messages/s, 1 under way each", round_trips(false, 1, small, NeedJob{1}),
      round_trips(true, 1, small, NeedJob{1}));
  row("MB/s, 2 MiB of pixels each", 2.1 * round_trips(false, 1, pixels, NeedJob{1}),
      2.1 * round_trips(true, 1, pixels, NeedJob{1}));
  row("connections/s, one after the other", connections(false), connections(true));
  return 0;
}

}  // namespace
}  // namespace tessera

int main() { return tessera::run(); }
