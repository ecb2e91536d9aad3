// SPDX-License-Identifier: Apache-2.0
// tessera cancel, pause, resume, priority, verify, remove, release: what is done to jobs and workers of a
// farm.
#include <memory>

#include "cli/farm_link.h"
#include "cli/subcommand.h"

namespace tessera {
namespace {

struct ControlCommand {
  LinkOptions link;
  std::vector<std::string> jobs;
  int value = 0;
};

std::function<int()> describe_verb(CLI::App& app, const std::shared_ptr<ControlCommand>& c, Verb verb) {
  add_link_options(app, c->link);
  return [c, verb] {
    FarmLink farm(c->link);
    for (const std::string& job : c->jobs) farm.ask<Agreed>(Control{job, verb, c->value});
    return 0;
  };
}

std::function<int()> describe_plain_verb(CLI::App& app, Verb verb) {
  auto c = std::make_shared<ControlCommand>();
  app.add_option("job", c->jobs, "One job or more")->required();
  return describe_verb(app, c, verb);
}

}  // namespace

std::function<int()> describe_cancel(CLI::App& app) { return describe_plain_verb(app, Verb::cancel); }
std::function<int()> describe_pause(CLI::App& app) { return describe_plain_verb(app, Verb::pause); }
std::function<int()> describe_resume(CLI::App& app) { return describe_plain_verb(app, Verb::resume); }

std::function<int()> describe_remove(CLI::App& app) {
  auto c = std::make_shared<ControlCommand>();
  app.add_option("job", c->jobs, "One job or more, that are over")->required();
  add_link_options(app, c->link);
  return [c] {
    FarmLink farm(c->link);
    for (const std::string& job : c->jobs) farm.ask<JobDetail>(ShowJob{job});  // or there is no such job
    for (const std::string& job : c->jobs) farm.ask<Agreed>(Control{job, Verb::remove, 0});
    return 0;
  };
}

std::function<int()> describe_priority(CLI::App& app) {
  auto c = std::make_shared<ControlCommand>();
  c->jobs.resize(1);
  app.add_option("job", c->jobs.front(), "Which job")->required();
  app.add_option("priority", c->value, "0 to 100; the higher, the sooner; above 50 only administrators")
      ->required()
      ->check(CLI::Range(0, kHighestPriority));
  return describe_verb(app, c, Verb::set_priority);
}

std::function<int()> describe_verify(CLI::App& app) {
  auto c = std::make_shared<ControlCommand>();
  c->jobs.resize(1);
  c->value = 8;
  app.add_option("job", c->jobs.front(), "Which job")->required();
  app.add_option("--tasks", c->value, "How many of its render tasks, taken at random, other workers do again")
      ->check(CLI::Range(1, 4096))
      ->capture_default_str();
  app.footer("What came of it: tessera jobs JOB --events");
  return describe_verb(app, c, Verb::verify);
}

std::function<int()> describe_release(CLI::App& app) {
  struct Release {
    LinkOptions link;
    std::string worker;
  };
  auto c = std::make_shared<Release>();
  app.add_option("worker", c->worker, "Its name, as tessera workers says it")->required();
  add_link_options(app, c->link);
  return [c] {
    FarmLink farm(c->link);
    farm.ask<Agreed>(ReleaseWorker{c->worker});
    return 0;
  };
}

}  // namespace tessera
