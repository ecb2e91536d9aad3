// SPDX-License-Identifier: Apache-2.0
// A job as it is asked for again and again while somebody watches it.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/farm_link.h"
#include "cli/watch_screen.h"
#include "coordinator/progress.h"

namespace tessera {

class WatchedJob {
 public:
  // `previews`: they are wanted.
  WatchedJob(FarmLink& farm, std::string job, bool previews)
      : farm_(farm), job_(std::move(job)), previews_(previews) {}

  // How it is now. Throws what FarmClient::ask() throws.
  const WatchView& look();
  const WatchView& view() const { return view_; }
  // What happened since the last look, in order.
  const std::vector<JobEvent>& news() const { return news_; }
  // A frame has stopped at a limit.
  bool limited() const { return limited_; }
  Progress progress() const;

  // The picture of the first frame under way, or of the last one that ended, replaces `file` if it is
  // another one than the last that did.
  void bring_preview(const std::filesystem::path& file);

 private:
  void look_at_frames();
  void hear_news();
  void look_at_workers();

  FarmLink& farm_;
  std::string job_;
  bool previews_;
  WatchView view_;
  std::vector<JobEvent> news_;
  std::uint32_t first_ = 0;  // all frames before are over
  std::uint64_t last_event_ = 0;
  bool limited_ = false;
  Digest preview_, ended_preview_;  // on disk; of the last frame that ended
};

}  // namespace tessera
