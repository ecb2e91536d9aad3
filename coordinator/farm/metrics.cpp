// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/metrics.h"

#include <fmt/format.h>

#include <iterator>
#include <string_view>

namespace tessera {
namespace {

std::string escaped(std::string_view label) {
  std::string text;
  for (const char c : label) {
    if (c == '\\' || c == '"') text += '\\';
    if (c == '\n')
      text += "\\n";
    else
      text += c;
  }
  return text;
}

class Page {
 public:
  // The samples that follow are of this metric.
  Page& gauge(std::string_view name, std::string_view help) { return metric(name, "gauge", help); }
  Page& counter(std::string_view name, std::string_view help) { return metric(name, "counter", help); }

  template <class Number>
  Page& is(Number value) {
    fmt::format_to(std::back_inserter(text_), "tessera_{} {}\n", name_, value);
    return *this;
  }
  template <class Number>
  Page& is(std::string_view label, std::string_view of, Number value) {
    fmt::format_to(std::back_inserter(text_), "tessera_{}{{{}=\"{}\"}} {}\n", name_, label, escaped(of),
                   value);
    return *this;
  }
  std::string text() && { return std::move(text_); }

 private:
  Page& metric(std::string_view name, std::string_view type, std::string_view help) {
    name_ = name;
    fmt::format_to(std::back_inserter(text_), "# HELP tessera_{0} {1}\n# TYPE tessera_{0} {2}\n", name, help,
                   type);
    return *this;
  }

  std::string text_, name_;
};

void add_process(Page& page, const FarmFigures& f) {
  page.gauge("build_info", "Version of the coordinator.").is("version", f.version, 1);
  page.gauge("uptime_seconds", "Since the coordinator began.").is(f.seconds);
  page.gauge("trouble", "1 while nothing goes on, as the store does not work.").is(f.trouble.empty() ? 0 : 1);
  page.gauge("memory_used_bytes", "Memory that frames under way are counted with.").is(f.memory_used);
  page.gauge("memory_free_bytes", "Memory left for frames.").is(f.memory_free);
  page.gauge("store_bytes", "Scenes, images and uploads in the store.").is(f.store_bytes);
}

void add_tasks(Page& page, const FarmFigures& f) {
  const SchedulerCounts& t = f.tasks;
  page.counter("tasks_assigned_total", "Tasks given to workers, each attempt.").is(t.assigned);
  page.counter("tasks_accepted_total", "Tasks whose result was taken, once each.").is(t.accepted);
  page.counter("tasks_failed_total", "Failures that workers told.").is(f.failed_tasks);
  page.counter("tasks_retried_total", "Tasks given out again after a failure or a loss.").is(t.retried);
  page.counter("tasks_revoked_total", "Tasks taken back from workers.").is(t.revoked);
  page.counter("tasks_moved_total", "Tasks moved from a queue to an idle slot.").is(t.moved);
  page.counter("tasks_doubled_total", "Second copies given out near the end.").is(t.doubled);
  page.counter("tasks_given_up_total", "Tasks that failed for good.").is(t.given_up);
  page.counter("results_dropped_total", "Results of tasks that were done already or not wanted.")
      .is(t.dropped);
  page.counter("verify_other_bits_total", "Tasks that came out otherwise when done again.").is(f.wrong_bits);
  page.gauge("tasks_waiting", "Tasks that no worker has.").is(t.waiting);
  page.gauge("tasks_running", "Tasks that some worker has.").is(t.running);
}

void add_work(Page& page, const FarmFigures& f) {
  page.gauge("workers", "Workers that are present.").is(f.tasks.workers);
  page.gauge("workers_set_aside", "Of them, those that get no tasks as they kept failing.")
      .is(f.tasks.set_aside);
  page.gauge("slots", "Tasks that workers do at a time.").is(f.slots);
  page.counter("pixel_samples_total", "Pixel samples taken in.").is(f.pixel_samples);
  page.gauge("pixel_samples_per_second", "Of the last ten seconds.").is(f.samples_per_second);
  page.counter("pixel_bytes_total", "Pixels from and to workers.").is("direction", "in", f.bytes_in);
  page.is("direction", "out", f.bytes_out);
}

void add_jobs(Page& page, const FarmFigures& f) {
  const auto of = [&](JobState s) { return f.jobs.at(static_cast<std::size_t>(s)); };
  page.gauge("jobs", "Jobs that are not over.").is("state", "queued", of(JobState::queued));
  page.is("state", "active", of(JobState::active)).is("state", "paused", of(JobState::paused));
  page.counter("jobs_ended_total", "Jobs that ended so.").is("state", "completed", of(JobState::completed));
  page.is("state", "failed", of(JobState::failed)).is("state", "cancelled", of(JobState::cancelled));
  page.gauge("job_fraction", "How much of an active job is done, 0 to 1.");
  for (const JobFigures& j : f.active) page.is("job", j.job, j.fraction);
  page.gauge("job_relmse", "Largest relMSE of an active job's frames at their last looks.");
  for (const JobFigures& j : f.active)
    if (j.error) page.is("job", j.job, *j.error);
  page.gauge("job_target_relmse", "The relMSE that is asked for.");
  for (const JobFigures& j : f.active)
    if (j.target) page.is("job", j.job, *j.target);
}

void add_road(Page& page, const RouterCounts& r) {
  page.counter("messages_total", "Messages taken in.").is(r.received);
  page.counter("message_bytes_total", "Bytes of them.").is(r.received_bytes);
  page.counter("messages_dropped_total", "Messages not taken in.").is("reason", "alien", r.alien);
  page.is("reason", "bad_id", r.bad_id).is("reason", "unknown_key", r.unknown_key);
  page.is("reason", "no_right", r.no_right).is("reason", "too_large", r.too_large);
  page.is("reason", "too_fast", r.too_fast);
  page.counter("messages_unsent_total", "Messages to peers for which there was no memory.").is(r.unsent);
  page.counter("connections_total", "Connections made.").is(r.connections);
  page.counter("connections_let_in_total", "Of them, those that were let in.").is(r.let_in);
  page.counter("connections_refused_total", "Connections refused.").is("reason", "key", r.refused_keys);
  page.is("reason", "handshake", r.refused_handshakes);
}

}  // namespace

std::string metrics_text(const FarmFigures& f) {
  Page page;
  add_process(page, f);
  add_tasks(page, f);
  add_work(page, f);
  add_jobs(page, f);
  add_road(page, f.router);
  return std::move(page).text();
}

}  // namespace tessera
