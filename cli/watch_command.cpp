// SPDX-License-Identifier: Apache-2.0
// tessera watch: a job's progress until it ends, as a screen of a terminal or as lines.
#include <fmt/format.h>
#include <sys/ioctl.h>
#include <unistd.h>

#include <condition_variable>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <mutex>
#include <optional>

#include "cli/job_words.h"
#include "cli/progress_display.h"
#include "cli/signals.h"
#include "cli/subcommand.h"
#include "cli/terminal_text.h"
#include "cli/watched_job.h"
#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kLook{1000};

struct WatchCommand {
  LinkOptions link;
  std::string job, preview, progress = "auto";
};

// A page of its own on the terminal from the first show() on; the terminal is as it was afterwards.
class Screen {
 public:
  Screen() = default;
  ~Screen() { leave(); }
  Screen(const Screen&) = delete;
  Screen& operator=(const Screen&) = delete;

  void show(const WatchView& view) {
    winsize window{};
    ScreenSize size;
    if (ioctl(STDOUT_FILENO, TIOCGWINSZ, &window) == 0 && window.ws_col > 0)
      size = {window.ws_col, window.ws_row};
    std::string text = "\x1b[H";
    const char* behind = "";
    for (const std::string& line : watch_screen(view, size, std::getenv("NO_COLOR") == nullptr)) {
      text += behind + line + "\x1b[K";
      behind = "\r\n";
    }
    const std::lock_guard lock(mutex_);
    if (left_) return;
    if (!entered_) put("\x1b[?1049h\x1b[?25l");
    entered_ = true;
    put(text + "\x1b[J");
  }
  // From any thread; nothing is shown from here on.
  void leave() {
    const std::lock_guard lock(mutex_);
    if (entered_ && !left_) put("\x1b[?25h\x1b[?1049l");
    left_ = true;
  }

 private:
  static void put(const std::string& text) {
    std::fwrite(text.data(), 1, text.size(), stdout);
    std::fflush(stdout);
  }

  std::mutex mutex_;
  bool entered_ = false, left_ = false;
};

// Waits, unless somebody wants it to end.
class Pause {
 public:
  void end() {
    const std::lock_guard lock(mutex_);
    ended_ = true;
    bell_.notify_all();
  }
  bool ended() const {
    const std::lock_guard lock(mutex_);
    return ended_;
  }
  bool wait(Millis duration) {  // false: it ended
    std::unique_lock lock(mutex_);
    return !bell_.wait_for(lock, duration, [this] { return ended_; });
  }

 private:
  mutable std::mutex mutex_;
  std::condition_variable bell_;
  bool ended_ = false;
};

class Watch {
 public:
  explicit Watch(const WatchCommand& command) : command_(command), style_(style_of(command)) {}

  int run() {
    if (on_screen()) screen_.emplace();
    const Signals signals([this](int signal) {
      if (signal == SIGUSR1) return;
      if (screen_) screen_->leave();
      pause_.end();
    });
    FarmLink farm(command_.link);
    WatchedJob job(farm, command_.job, !command_.preview.empty());
    ProgressDisplay display(on_screen() ? ProgressStyle::none : style_, stdout);
    do {
      job.look();
      if (!command_.preview.empty()) job.bring_preview(command_.preview);
      show(job, display);
    } while (!is_over(job.view().job) && pause_.wait(kLook));
    if (!is_over(job.view().job)) return static_cast<int>(ExitCode::interrupted);
    return ended(job);
  }

 private:
  static ProgressStyle style_of(const WatchCommand& c) {
    if (c.progress == "none") return ProgressStyle::none;
    if (c.progress == "bar") return ProgressStyle::bar;
    if (c.progress == "lines") return ProgressStyle::lines;
    if (c.progress == "json") return ProgressStyle::json;
    if (c.progress == "openjd") return ProgressStyle::openjd;
    return usual_progress_style(isatty(STDOUT_FILENO) != 0, std::getenv("OPENJD_SESSION_WORKING_DIR"));
  }
  // A terminal is the screen's, unless something else was asked for.
  bool on_screen() const { return command_.progress == "auto" && style_ == ProgressStyle::bar; }

  void show(const WatchedJob& job, ProgressDisplay& display) {
    if (screen_) return screen_->show(job.view());
    for (const JobEvent& event : job.news())
      if (style_ == ProgressStyle::lines) fmt::print("{}\n", plain(line_of(event)));
    display.show(job.progress(), std::chrono::duration<double>(clock_now().time_since_epoch()).count());
    std::fflush(stdout);
  }

  int ended(const WatchedJob& job) {
    const JobSummary& summary = job.view().job;
    const ExitCode code = exit_code(summary, job.limited());
    if (screen_) screen_->leave();
    if (style_ == ProgressStyle::openjd && code == ExitCode::job_failed)
      fmt::print("openjd_fail: {}\n", plain(summary.reason));
    else if (screen_ || style_ == ProgressStyle::lines)
      fmt::print("{}\n", plain(line_of(summary)));
    return static_cast<int>(code);
  }

  const WatchCommand& command_;
  ProgressStyle style_;
  std::optional<Screen> screen_;
  Pause pause_;
};

}  // namespace

std::function<int()> describe_watch(CLI::App& app) {
  auto c = std::make_shared<WatchCommand>();
  app.add_option("job", c->job, "Which job")->required();
  app.add_option("--preview", c->preview, "PNG to write again and again as the picture grows");
  app.add_option("--progress", c->progress, "How to show it; auto: a screen on a terminal, lines elsewhere")
      ->check(CLI::IsMember({"auto", "bar", "lines", "json", "openjd", "none"}))
      ->envname("TESSERA_PROGRESS")
      ->capture_default_str();
  add_link_options(app, c->link);
  return [c] { return Watch(*c).run(); };
}

}  // namespace tessera
