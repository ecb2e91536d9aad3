// SPDX-License-Identifier: Apache-2.0
#include "cli/under_way.h"

#include <unistd.h>

#include <csignal>

#include "core/error.h"

namespace tessera {

UnderWay::Watch::Watch(UnderWay& under_way, Coordinator& coordinator) : under_way_(under_way) {
  const std::lock_guard lock(under_way_.mutex_);
  under_way_.coordinator_ = &coordinator;
  under_way_.begun_ = true;
}

UnderWay::Watch::~Watch() {
  const std::lock_guard lock(under_way_.mutex_);
  under_way_.coordinator_ = nullptr;
}

void UnderWay::hear(int signal) {
  const std::lock_guard lock(mutex_);
  if (!begun_ && signal != SIGUSR1) _exit(static_cast<int>(ExitCode::interrupted));
  if (coordinator_ == nullptr) return;
  signal == SIGUSR1 ? coordinator_->request_snapshot() : coordinator_->interrupt();
}

}  // namespace tessera
