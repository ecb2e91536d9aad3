// SPDX-License-Identifier: Apache-2.0
// SIGINT, SIGTERM, SIGUSR1 and, if wanted, others as calls on a thread of their own, so that no handler runs
// inside anything.
#pragma once

#include <csignal>
#include <functional>
#include <initializer_list>
#include <thread>

namespace tessera {

// While it lives, the signals go to `heard`; create it before any other thread, which then inherit the mask.
// A second SIGINT or SIGTERM ends the process at once, with 130.
class Signals {
 public:
  explicit Signals(std::function<void(int signal)> heard, std::initializer_list<int> others = {});
  ~Signals();
  Signals(const Signals&) = delete;

 private:
  sigset_t set_;
  std::jthread thread_;
};

}  // namespace tessera
