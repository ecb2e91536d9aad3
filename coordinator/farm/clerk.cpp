// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/clerk.h"

#include <fmt/format.h>

#include <utility>

namespace tessera {

namespace {

std::filesystem::path emptied(std::filesystem::path folder) {
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  return folder;
}

}  // namespace

Clerk::Clerk(std::filesystem::path folder, std::function<void()> rung)
    : folder_(emptied(std::move(folder))),
      rung_(std::move(rung)),
      thread_([this](const std::stop_token& token) { live(token); }) {}

Clerk::~Clerk() = default;

void Clerk::write(Paperwork work) {
  const std::lock_guard lock(mutex_);
  waiting_.push_back(std::move(work));
  bell_.notify_one();
}

std::vector<Written> Clerk::done() {
  const std::lock_guard lock(mutex_);
  return std::exchange(done_, {});
}

void Clerk::live(const std::stop_token& token) {
  for (;;) {
    Paperwork work;
    {
      std::unique_lock lock(mutex_);
      if (!bell_.wait(lock, token, [this] { return !waiting_.empty(); })) return;
      work = std::move(waiting_.front());
      waiting_.pop_front();
    }
    Written written = attempt(std::move(work));
    {
      const std::lock_guard lock(mutex_);
      done_.push_back(std::move(written));
    }
    rung_();
  }
}

Written Clerk::attempt(Paperwork work) const {
  const auto file = [&](const char* extension) {
    return folder_ / fmt::format("{}.{}.{}", work.job, work.place, extension);
  };
  Written written{.exr = file("exr"), .png = file("png")};
  try {
    write_frame(written.exr, written.png, work.frame, work.report, work.style, work.key);
  } catch (const std::exception& e) {
    written.trouble = e.what();
  }
  written.of = std::move(work);
  return written;
}

}  // namespace tessera
