// SPDX-License-Identifier: Apache-2.0
// Writes the files of frames that have ended in a thread of its own: compressing an image takes longer than
// workers should wait for an answer.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "coordinator/frame_writer.h"
#include "core/submission.h"

namespace tessera {

// A frame to write.
struct Paperwork {
  JobName job;
  std::size_t place = 0;  // in the job
  Job frame;
  JobReport report;
  FrameStyle style;
  std::string key;
};
// It is there, or it cannot be written.
struct Written {
  Paperwork of;
  std::filesystem::path exr, png;
  std::optional<std::string> trouble;
};

class Clerk {
 public:
  // Files are made in `folder`, of which all that is there is removed; `rung` is called, in the clerk's
  // thread, whenever something is done.
  Clerk(std::filesystem::path folder, std::function<void()> rung);
  ~Clerk();

  void write(Paperwork work);
  std::vector<Written> done();

 private:
  void live(const std::stop_token& token);
  Written attempt(Paperwork work) const;

  std::filesystem::path folder_;
  std::function<void()> rung_;
  std::mutex mutex_;  // guards the next two
  std::deque<Paperwork> waiting_;
  std::vector<Written> done_;
  std::condition_variable_any bell_;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace tessera
