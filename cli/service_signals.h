// SPDX-License-Identifier: Apache-2.0
// Signals of what runs until it is told to stop: SIGTERM and SIGINT stop it, SIGHUP has it read its keys
// again.
#pragma once

#include <functional>
#include <mutex>

#include "cli/signals.h"

namespace tessera {

class ServiceSignals {
 public:
  // To be made before any other thread. `told`: called at once when the first of them asks for a stop.
  explicit ServiceSignals(std::function<void()> told = {});

  // While it lives, signals reach what runs; a stop that came before reaches it now.
  class Reach {
   public:
    Reach(ServiceSignals& signals, std::function<void()> stop, std::function<void()> reload);
    ~Reach();
    Reach(const Reach&) = delete;

   private:
    ServiceSignals& signals_;
  };

 private:
  void hear(int signal);

  std::mutex mutex_;  // guards all but `signals_`
  std::function<void()> told_, stop_, reload_;
  bool stopped_ = false;
  Signals signals_;  // last: it calls
};

}  // namespace tessera
