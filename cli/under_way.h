// SPDX-License-Identifier: Apache-2.0
// What signals act on: nothing that is worth writing yet, frames under way, or files being written.
#pragma once

#include <mutex>

#include "coordinator/coordinator.h"

namespace tessera {

class UnderWay {
 public:
  // While it lives, signals reach `coordinator`.
  class Watch {
   public:
    Watch(UnderWay& under_way, Coordinator& coordinator);
    ~Watch();
    Watch(const Watch&) = delete;

   private:
    UnderWay& under_way_;
  };

  // SIGUSR1: a snapshot. Others: an end with what there is; at once, as long as there is nothing.
  void hear(int signal);

 private:
  std::mutex mutex_;
  Coordinator* coordinator_ = nullptr;  // borrowed while there is a Watch
  bool begun_ = false;
};

}  // namespace tessera
