// SPDX-License-Identifier: Apache-2.0
#include "cli/signals.h"

#include <pthread.h>
#include <unistd.h>

#include "core/error.h"

namespace tessera {
namespace {

constexpr int kNudge = SIGUSR2;

void listen(const std::stop_token& over, const sigset_t& set, const std::function<void(int)>& heard) {
  bool asked_to_stop = false;
  for (int signal = 0; sigwait(&set, &signal) == 0 && !over.stop_requested();) {
    if (signal == kNudge) continue;  // somebody else's
    const bool ends = signal == SIGINT || signal == SIGTERM;
    if (ends && asked_to_stop) _exit(static_cast<int>(ExitCode::interrupted));
    asked_to_stop |= ends;
    heard(signal);
  }
}

}  // namespace

Signals::Signals(std::function<void(int)> heard, std::initializer_list<int> others) {
  sigemptyset(&set_);
  for (int signal : {SIGINT, SIGTERM, SIGUSR1, kNudge}) sigaddset(&set_, signal);
  for (int signal : others) sigaddset(&set_, signal);
  pthread_sigmask(SIG_BLOCK, &set_, nullptr);
  thread_ = std::jthread(
      [set = set_, heard = std::move(heard)](const std::stop_token& over) { listen(over, set, heard); });
}

Signals::~Signals() {
  thread_.request_stop();
  pthread_kill(thread_.native_handle(), kNudge);
  thread_.join();
  pthread_sigmask(SIG_UNBLOCK, &set_, nullptr);
}

}  // namespace tessera
