// SPDX-License-Identifier: Apache-2.0
#include "cli/key_watch.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include <utility>

#include "core/error.h"

namespace tessera {
namespace {

FileStamp stamp(const std::filesystem::path& file) {
  struct stat s = {};
  if (file.empty() || stat(file.c_str(), &s) != 0) return {};
  return {s.st_dev, s.st_ino, static_cast<std::uint64_t>(s.st_size), s.st_mtim.tv_sec, s.st_mtim.tv_nsec};
}

std::array<FileStamp, 3> stamps(const KeyFiles& files) {
  return {stamp(files.key), stamp(files.allow), stamp(files.server_key)};
}

}  // namespace

KeyWatch::KeyWatch(KeyFiles files, ZmqRouter& road, Say say, Millis interval)
    : KeyWatch(
          files,
          [files, &road] {
            ServerKeys keys = read_server_keys(files).value();
            const std::size_t allowed = keys.allowed.keys.size();
            const std::string own = keys.pair.public_key;
            road.reload(std::move(keys));
            return fmt::format("keys: {} allowed from now on; this coordinator's is {}", allowed, own);
          },
          std::move(say), interval) {}

KeyWatch::KeyWatch(KeyFiles files, ZmqDealer& road, Say say, Millis interval)
    : KeyWatch(
          files,
          [files, &road] {
            ClientKeys keys = read_client_keys(files).value();
            const std::string own = keys.pair.public_key;
            road.reload(std::move(keys));
            return fmt::format("keys: connects as {} from now on", own);
          },
          std::move(say), interval) {}

KeyWatch::KeyWatch(KeyFiles files, std::function<std::string()> reload, Say say, Millis interval)
    : files_(std::move(files)),
      reload_(std::move(reload)),
      say_(std::move(say)),
      interval_(interval),
      taken_(stamps(files_)),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

KeyWatch::~KeyWatch() = default;

void KeyWatch::look() {
  const std::lock_guard lock(mutex_);
  asked_ = true;
  bell_.notify_all();
}

void KeyWatch::run(const std::stop_token& stop) {
  auto before = taken_;
  while (!stop.stop_requested()) {
    {
      std::unique_lock lock(mutex_);
      bell_.wait_for(lock, stop, interval_, [this] { return asked_; });
    }
    if (stop.stop_requested()) return;
    const auto now = stamps(files_);
    bool asked = false;
    {
      const std::lock_guard lock(mutex_);
      asked = std::exchange(asked_, false);
    }
    if (asked || (now != taken_ && now == before)) {
      try_reload();
      taken_ = now;
    }
    before = now;
  }
}

void KeyWatch::try_reload() {
  try {
    say_(reload_());
  } catch (const std::exception& error) {
    say_(fmt::format("keys: NOT changed, those from before stay in force: {}", error.what()));
  }
}

}  // namespace tessera
