// SPDX-License-Identifier: Apache-2.0
#include "cli/fetching.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <filesystem>
#include <set>
#include <thread>

#include "cli/job_words.h"
#include "cli/progress_display.h"
#include "core/sequence.h"
#include "core/sha256.h"
#include "proto/clock.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// At the least between looks: the coordinator answers when there is something new.
constexpr Millis kLook{20};

class Fetch {
 public:
  Fetch(FarmLink& farm, const Fetching& what) : farm_(farm), what_(what) {
    if (what.frames.empty()) return;
    for (const int frame : parse_frames(what.frames)) wanted_.insert(frame);
  }

  ExitCode run() {
    for (;;) {
      const Instant begin = clock_now();
      const JobSummary job = look();
      show(job);
      if (is_over(job) || !what_.wait) return is_over(job) ? exit_code(job, limited_) : ExitCode::done;
      std::this_thread::sleep_until(begin + kLook);
    }
  }

 private:
  // Asks for all frames that are not here yet, and fetches those that are there.
  JobSummary look() {
    JobDetail page = farm_.ask<JobDetail>(ShowJob{what_.job, first_, what_.growing, stamp_});
    stamp_ = page.stamp;
    const JobSummary job = page.summary;
    require_pattern(job);
    bool gap = false;
    for (std::uint32_t place = first_;;) {
      for (const FrameSummary& frame : page.frames) {
        const bool settled = take(frame);
        gap = gap || !settled;
        ++place;
        if (!gap) first_ = place;
      }
      if (page.frames.empty() || place >= job.frames) return job;
      page = farm_.ask<JobDetail>(ShowJob{what_.job, place, what_.growing});
    }
  }

  void require_pattern(const JobSummary& job) const {
    if (what_.output.empty() || job.frames == 1 || is_pattern(what_.output)) return;
    throw Error(
        ExitCode::bad_usage,
        fmt::format("--output: '{}' has no place for the number of {} frames; accepted: name.####.exr",
                    what_.output, job.frames));
  }

  // True if nothing more is to come of it.
  bool take(const FrameSummary& frame) {
    const bool failed = frame.state == FrameState::failed;
    if (!failed && frame.image.empty()) {
      bring_growing(frame);
      return false;
    }
    if (!taken_.insert(frame.frame).second) return true;
    limited_ = limited_ || frame.state == FrameState::limited;
    const bool wanted = wanted_.empty() || wanted_.contains(frame.frame);
    fs::path file;
    if (!failed && wanted && !what_.output.empty()) bring_all(frame, file = file_of_frame(frame.frame));
    if (what_.told) what_.told(frame, file);
    return true;
  }

  void bring_all(const FrameSummary& frame, const fs::path& file) {
    bring(frame.image, file);
    if (what_.told) return;
    bring(frame.preview, fs::path(file).replace_extension(".png"));
    if (!what_.quiet) fmt::print(stderr, "{}{}\n", line_end(), file.string());
  }

  fs::path file_of_frame(int frame) const {
    fs::path file = is_pattern(what_.output) ? file_of(what_.output, frame) : fs::path(what_.output);
    if (file.has_parent_path()) fs::create_directories(file.parent_path());
    return file;
  }

  // As far as the picture is known.
  void bring_growing(const FrameSummary& frame) {
    const bool wanted = wanted_.empty() || wanted_.contains(frame.frame);
    if (!what_.growing || !wanted || what_.output.empty() || frame.preview.empty()) return;
    try {
      bring(frame.preview, file_of_frame(frame.frame).replace_extension(".png"));
    } catch (const Error& e) {
      if (e.code() != ExitCode::bad_input) throw;  // there is a newer one already
    }
  }

  void bring(const Digest& blob, const fs::path& file) {
    if (!fs::exists(file) || sha256_of_file(file) != blob) farm_.client().download(blob, file);
  }

  const char* line_end() const { return isatty(STDERR_FILENO) != 0 && what_.wait ? "\r\033[K" : ""; }

  void show(const JobSummary& job) {
    if (what_.quiet || !what_.wait) return;
    const std::string line = fmt::format(
        "{} {:.1f} %, {} of {} frames{}", to_string(job.state), 100 * job.fraction, job.frames_done,
        job.frames, job.seconds_left ? ", " + duration_words(*job.seconds_left) + " left" : "");
    if (isatty(STDERR_FILENO) != 0)
      fmt::print(stderr, "\r\033[K{}{}", line, is_over(job) ? "\n" : "");
    else if (line != last_)
      fmt::print(stderr, "{}\n", line);
    last_ = line;
    if (is_over(job) && !job.reason.empty()) fmt::print(stderr, "{}\n", job.reason);
  }

  FarmLink& farm_;
  const Fetching& what_;
  std::set<int> wanted_, taken_;
  std::uint32_t first_ = 0;  // all frames before are here, or will not come
  std::uint64_t stamp_ = 0;  // of the last answer
  bool limited_ = false;
  std::string last_;
};

}  // namespace

ExitCode fetch_job(FarmLink& farm, const Fetching& what) { return Fetch(farm, what).run(); }

}  // namespace tessera
