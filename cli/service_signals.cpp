// SPDX-License-Identifier: Apache-2.0
#include "cli/service_signals.h"

#include <csignal>
#include <utility>

namespace tessera {

ServiceSignals::ServiceSignals(std::function<void()> told)
    : told_(std::move(told)), signals_([this](int signal) { hear(signal); }, {SIGHUP}) {
  // A file that grows beyond a limit is an error of that file, and no reason to die.
  std::signal(SIGXFSZ, SIG_IGN);
}

void ServiceSignals::hear(int signal) {
  const std::lock_guard lock(mutex_);
  if (signal == SIGHUP && reload_) reload_();
  if (signal != SIGTERM && signal != SIGINT) return;
  stopped_ = true;
  if (told_) told_();
  if (stop_) stop_();
}

ServiceSignals::Reach::Reach(ServiceSignals& signals, std::function<void()> stop,
                             std::function<void()> reload)
    : signals_(signals) {
  const std::lock_guard lock(signals_.mutex_);
  signals_.stop_ = std::move(stop);
  signals_.reload_ = std::move(reload);
  if (signals_.stopped_) signals_.stop_();
}

ServiceSignals::Reach::~Reach() {
  const std::lock_guard lock(signals_.mutex_);
  signals_.stop_ = nullptr;
  signals_.reload_ = nullptr;
}

}  // namespace tessera
