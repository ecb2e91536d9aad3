// SPDX-License-Identifier: Apache-2.0
#include "cli/job_words.h"

#include <fmt/chrono.h>
#include <fmt/format.h>

#include <array>
#include <cmath>
#include <nlohmann/json.hpp>

namespace tessera {

using nlohmann::json;

std::string_view to_string(JobState state) {
  constexpr std::array<std::string_view, 6> kNames{"queued",    "active", "paused",
                                                   "completed", "failed", "cancelled"};
  return kNames.at(static_cast<std::size_t>(state));
}

std::string_view to_string(FrameState state) {
  constexpr std::array<std::string_view, 5> kNames{"waiting", "active", "completed", "limited", "failed"};
  return kNames.at(static_cast<std::size_t>(state));
}

std::string duration_words(double seconds) {
  const auto s = static_cast<std::int64_t>(std::llround(std::max(0.0, seconds)));
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{} min {} s", s / 60, s % 60);
  return fmt::format("{} h {} min", s / 3600, s / 60 % 60);
}

std::string time_words(std::int64_t ms) {
  return fmt::format("{:%Y-%m-%dT%H:%M:%S}Z", fmt::gmtime(static_cast<std::time_t>(ms / 1000)));
}

std::string line_of(const JobSummary& j) {
  std::string line =
      fmt::format("{:<28} {:<9} {:>5.1f} %  {:>4}/{:<4} {:>3}  {:<12} {}", j.job, to_string(j.state),
                  100 * j.fraction, j.frames_done, j.frames, j.priority, j.owner, j.name);
  if (j.seconds_left) line += fmt::format("  {} left", duration_words(*j.seconds_left));
  if (!j.reason.empty()) line += "  (" + j.reason + ")";
  return line;
}

std::string line_of(const FrameSummary& f) {
  std::string line = fmt::format("frame {:>6}  {:<9} {:>5.1f} %  round {:>2}", f.frame, to_string(f.state),
                                 100 * f.fraction, f.round);
  if (f.error) line += fmt::format("  relMSE {:.3g}", *f.error);
  if (f.target) line += fmt::format(" of {:.3g}", *f.target);
  if (f.seconds > 0) line += fmt::format("  {}", duration_words(f.seconds));
  if (!f.reason.empty()) line += "  (" + f.reason + ")";
  return line;
}

std::string line_of(const WorkerSummary& w) {
  std::string line = fmt::format("{:<24} {:>4} slots {:>4} tasks  {:>8} done {:>5} failed  {}", w.name,
                                 w.slots, w.held, w.done, w.failed, w.device_class);
  if (!w.set_aside.empty()) line += "  SET ASIDE: " + w.set_aside;
  return line;
}

std::string line_of(const JobEvent& e) { return fmt::format("{} {}", time_words(e.when), e.text); }

json json_of(const JobSummary& j) {
  json out{{"number", j.number},
           {"job", j.job},
           {"name", j.name},
           {"owner", j.owner},
           {"state", to_string(j.state)},
           {"reason", j.reason},
           {"priority", j.priority},
           {"frames", j.frames},
           {"frames_done", j.frames_done},
           {"frames_failed", j.frames_failed},
           {"submitted", time_words(j.submitted)},
           {"fraction", j.fraction},
           {"seconds", j.seconds},
           {"pixel_samples", j.pixel_samples}};
  if (j.seconds_left) out["seconds_left"] = *j.seconds_left;
  return out;
}

json json_of(const FrameSummary& f) {
  json out{{"frame", f.frame},           {"state", to_string(f.state)},
           {"reason", f.reason},         {"round", f.round},
           {"tiles_done", f.tiles_done}, {"tiles", f.tiles},
           {"fraction", f.fraction},     {"acceptable_share", f.acceptable_share},
           {"seconds", f.seconds},       {"errors", f.errors},
           {"image", f.image},           {"preview", f.preview}};
  if (f.error) out["error"] = *f.error;
  if (f.target) out["target"] = *f.target;
  return out;
}

json json_of(const WorkerSummary& w) {
  return {{"id", w.id},       {"name", w.name},     {"device_class", w.device_class},
          {"slots", w.slots}, {"held", w.held},     {"tasks_per_second", w.tasks_per_second},
          {"done", w.done},   {"failed", w.failed}, {"set_aside", w.set_aside}};
}

json json_of(const JobEvent& e) {
  return {{"number", e.number}, {"time", time_words(e.when)}, {"text", e.text}};
}

bool is_over(const JobSummary& j) {
  return j.state == JobState::completed || j.state == JobState::failed || j.state == JobState::cancelled;
}

ExitCode exit_code(const JobSummary& j, bool limited) {
  if (j.state != JobState::completed) return ExitCode::job_failed;
  return limited ? ExitCode::stopped_at_limit : ExitCode::done;
}

}  // namespace tessera
