// SPDX-License-Identifier: Apache-2.0
// Writes the files of frames that have ended, and draws those under way, in a thread of its own: compressing
// an image, and seeing it to the disk, takes longer than workers should wait for an answer.
#pragma once

#include <condition_variable>
#include <deque>
#include <filesystem>
#include <functional>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <variant>
#include <vector>

#include "coordinator/frame_writer.h"
#include "coordinator/store/blob_store.h"
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
  struct File {
    std::filesystem::path path;
    Digest seal;  // see sealed()
  };
  Paperwork of;
  File exr, png;
  std::optional<std::string> trouble;
};

// A picture to draw.
struct Sketch {
  JobName job;
  std::size_t place = 0;
  Image rgb;            // linear
  double exposure = 0;  // stops
};
struct Drawn {
  JobName job;
  std::size_t place = 0;
  std::string png;  // empty: it could not be drawn
};

class Clerk {
 public:
  // Files are made in `folder`, of which all that is there is removed; `rung` is called, in the clerk's
  // thread, whenever something is done. `sync`: files that are written survive a power cut.
  Clerk(std::filesystem::path folder, bool sync, std::function<void()> rung);
  ~Clerk();

  void write(Paperwork work);
  std::vector<Written> done();
  void draw(Sketch sketch);
  std::vector<Drawn> drawn();

 private:
  void live(const std::stop_token& token);
  void add(std::variant<Paperwork, Sketch> work);
  Written attempt(Paperwork work) const;
  Drawn attempt(const Sketch& sketch) const;

  std::filesystem::path folder_;
  bool sync_;
  std::function<void()> rung_;
  std::mutex mutex_;  // guards the next three
  std::deque<std::variant<Paperwork, Sketch>> waiting_;
  std::vector<Written> done_;
  std::vector<Drawn> drawn_;
  std::condition_variable_any bell_;
  std::jthread thread_;  // last: it ends before what it uses
};

}  // namespace tessera
