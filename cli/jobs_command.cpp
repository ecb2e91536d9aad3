// SPDX-License-Identifier: Apache-2.0
// tessera jobs, workers: what a farm has.
#include <fmt/format.h>

#include <memory>
#include <nlohmann/json.hpp>

#include "cli/farm_link.h"
#include "cli/job_words.h"
#include "cli/subcommand.h"

namespace tessera {
namespace {

struct JobsCommand {
  LinkOptions link;
  std::string job;
  bool json = false, events = false, all = false;
};

// Lines, or one array.
template <class Thing>
void print(const std::vector<Thing>& things, bool json) {
  nlohmann::json array = nlohmann::json::array();
  for (const Thing& thing : things) {
    if (json)
      array.push_back(json_of(thing));
    else
      fmt::print("{}\n", line_of(thing));
  }
  if (json) fmt::print("{}\n", array.dump(2));
}

int list_jobs(FarmLink& farm, const JobsCommand& c) {
  std::vector<JobSummary> jobs;
  for (std::uint64_t after = 0;;) {
    JobList page = farm.ask<JobList>(ListJobs{after});
    if (page.jobs.empty()) break;
    after = page.jobs.back().number;
    for (JobSummary& job : page.jobs)
      if (c.all || !is_over(job)) jobs.push_back(std::move(job));
  }
  if (jobs.empty() && !c.json)
    fmt::print("no jobs{}\n", c.all ? "" : " under way; --all lists those that are over");
  print(jobs, c.json);
  return 0;
}

int list_events(FarmLink& farm, const JobsCommand& c) {
  std::vector<JobEvent> events;
  for (;;) {
    EventList page = farm.ask<EventList>(ListEvents{c.job, events.empty() ? 0 : events.back().number});
    if (page.events.empty()) break;
    events.insert(events.end(), page.events.begin(), page.events.end());
  }
  print(events, c.json);
  return 0;
}

int show_job(FarmLink& farm, const JobsCommand& c) {
  JobDetail detail = farm.ask<JobDetail>(ShowJob{c.job, 0});
  std::vector<FrameSummary> frames = std::move(detail.frames);
  while (frames.size() < detail.summary.frames) {
    JobDetail page = farm.ask<JobDetail>(ShowJob{c.job, static_cast<std::uint32_t>(frames.size())});
    if (page.frames.empty()) break;
    for (FrameSummary& frame : page.frames) frames.push_back(std::move(frame));
  }
  if (c.json) {
    nlohmann::json out = json_of(detail.summary);
    for (const FrameSummary& frame : frames) out["frame_list"].push_back(json_of(frame));
    fmt::print("{}\n", out.dump(2));
    return 0;
  }
  fmt::print("{}\n", line_of(detail.summary));
  print(frames, false);
  return 0;
}

int run_jobs(const JobsCommand& c) {
  FarmLink farm(c.link);
  if (c.job.empty()) return list_jobs(farm, c);
  return c.events ? list_events(farm, c) : show_job(farm, c);
}

int run_workers(const JobsCommand& c) {
  FarmLink farm(c.link);
  std::vector<WorkerSummary> workers;
  for (;;) {
    WorkerList page = farm.ask<WorkerList>(ListWorkers{workers.empty() ? "" : workers.back().id});
    if (page.workers.empty()) break;
    workers.insert(workers.end(), page.workers.begin(), page.workers.end());
  }
  if (workers.empty() && !c.json) fmt::print("no workers\n");
  print(workers, c.json);
  return 0;
}

}  // namespace

std::function<int()> describe_jobs(CLI::App& app) {
  auto c = std::make_shared<JobsCommand>();
  app.add_option("job", c->job, "One job with its frames [all that are under way]");
  app.add_flag("--all", c->all, "Those that are over, too");
  app.add_flag("--events", c->events, "What happened to the job");
  app.add_flag("--json", c->json, "For programs");
  add_link_options(app, c->link);
  return [c] { return run_jobs(*c); };
}

std::function<int()> describe_workers(CLI::App& app) {
  auto c = std::make_shared<JobsCommand>();
  app.add_flag("--json", c->json, "For programs");
  add_link_options(app, c->link);
  return [c] { return run_workers(*c); };
}

}  // namespace tessera
