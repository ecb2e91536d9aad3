// SPDX-License-Identifier: Apache-2.0
// Keys that change while a process runs: it looks at their files again and again, and hands over what they
// say now. Files that cannot be read, or say nothing that is accepted, leave the keys from before in force.
#pragma once

#include <array>
#include <condition_variable>
#include <cstdint>
#include <functional>
#include <mutex>
#include <string_view>
#include <thread>

#include "core/instant.h"
#include "proto/key_files.h"
#include "proto/zmq_transport.h"

namespace tessera {

// What differs when a file was changed or another put in its place; all zero if there is none.
struct FileStamp {
  std::uint64_t device = 0, file = 0, size = 0;
  std::int64_t seconds = 0, nanoseconds = 0;
  bool operator==(const FileStamp&) const = default;
};

class KeyWatch {
 public:
  // Called on a thread of its own, with one line each: what was taken over, or why nothing was.
  using Say = std::function<void(std::string_view)>;

  // `road` has keys from `files`, and outlives this. A change counts when it has stood for `interval`, so
  // that a file that is being written is not read. Files are best renamed into their place.
  KeyWatch(KeyFiles files, ZmqRouter& road, Say say, Millis interval = Millis{1000});
  KeyWatch(KeyFiles files, ZmqDealer& road, Say say, Millis interval = Millis{1000});
  ~KeyWatch();

  void look();  // now, changed or not: for SIGHUP. Any thread

 private:
  KeyWatch(KeyFiles files, std::function<std::string()> reload, Say say, Millis interval);
  void run(const std::stop_token& stop);
  void try_reload();

  KeyFiles files_;
  std::function<std::string()> reload_;  // says what it took over; throws Error
  Say say_;
  Millis interval_;
  std::array<FileStamp, 3> taken_;  // as they were when they were last read; from before the thread begins
  std::mutex mutex_;                // guards the next
  bool asked_ = false;
  std::condition_variable_any bell_;
  std::jthread thread_;
};

}  // namespace tessera
