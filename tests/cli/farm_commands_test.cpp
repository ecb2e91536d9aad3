// SPDX-License-Identifier: Apache-2.0
// A farm as people run it: processes that find each other over a socket, and commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "core/exr.h"
#include "tests/cli/program.h"

namespace tessera {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

// A program that runs until it is told to stop.
class Running {
 public:
  // Returns when it has said `sign`, or has ended.
  Running(std::vector<std::string> arguments, const std::string& sign) {
    auto said = std::make_shared<std::promise<void>>();
    auto heard = said->get_future();
    thread_ = std::thread([this, arguments = std::move(arguments), sign, said] {
      bool told = false;
      outcome_ = run(arguments, [&](pid_t child, const std::string& line) {
        child_ = child;
        if (!told && line.find(sign) != line.npos) said->set_value(), told = true;
      });
      if (!told) said->set_value();
    });
    heard.wait();
  }
  ~Running() { stop(); }

  Outcome stop(int signal = SIGTERM) {
    if (child_ > 0) kill(child_, signal);
    if (thread_.joinable()) thread_.join();
    child_ = 0;
    return outcome_;
  }

 private:
  std::atomic<pid_t> child_ = 0;
  Outcome outcome_;
  std::thread thread_;
};

class FarmCommands : public Program {
 protected:
  void SetUp() override {
    Program::SetUp();
    if (IsSkipped()) return;
    address_ = "ipc://" + path("farm");
    start_coordinator();
  }
  void TearDown() override {
    workers_.clear();
    coordinator_.reset();
    Program::TearDown();
  }

  void start_coordinator() {
    coordinator_ =
        std::make_unique<Running>(std::vector<std::string>{"coordinator", "--listen", address_, "--store",
                                                           path("store"), "--http", "none", "--silence", "2"},
                                  "listens");
  }
  void hire(const std::string& name) {
    workers_.push_back(std::make_unique<Running>(
        std::vector<std::string>{"worker", "--coordinator", address_, "--threads", "1", "--name", name,
                                 "--cache", path("cache-" + name)},
        "works for"));
  }
  Outcome command(std::vector<std::string> words) const {
    words.insert(words.end(), {"--coordinator", address_});
    return run(words);
  }
  std::vector<std::string> job(const std::string& name, std::vector<std::string> more) const {
    std::vector<std::string> words{"submit", cornell_,   "--job", name,       "--width",
                                   "96",     "--height", "64",    "--filter", "svgf:levels=2"};
    words.insert(words.end(), more.begin(), more.end());
    return words;
  }
  nlohmann::json state_of(const std::string& name) const {
    return nlohmann::json::parse(command({"jobs", name, "--json"}).text);
  }

  std::string address_;
  std::unique_ptr<Running> coordinator_;
  std::vector<std::unique_ptr<Running>> workers_;
};

TEST_F(FarmCommands, MakeTheImageOfALocalRenderOnTwoWorkers) {
  hire("one");
  hire("two");
  const Outcome farm = command(job("box", {"--samples", "32", "-o", path("farm.exr")}));
  EXPECT_EQ(farm.code, 0) << farm.text;
  run({"render", cornell_, "--width", "96", "--height", "64", "--samples", "32", "--filter", "svgf:levels=2",
       "-o", path("local.exr")});
  const ExrImage a = read_exr(path("farm.exr")), b = read_exr(path("local.exr"));
  EXPECT_EQ(a.channels, b.channels);
  EXPECT_EQ(a.pixels, b.pixels);
  EXPECT_TRUE(fs::exists(path("farm.png")));
  EXPECT_EQ(state_of("box")["state"], "completed");
  EXPECT_THAT(command({"workers"}).text, AllOf(HasSubstr("one"), HasSubstr("two")));
  EXPECT_THAT(command({"jobs", "box", "--events"}).text, HasSubstr("completed"));
}

TEST_F(FarmCommands, GoOnAfterTheCoordinatorIsKilled) {
  hire("one");
  const Outcome submitted = command(job("shot", {"--samples", "64", "--frames", "1-3"}));
  EXPECT_EQ(submitted.code, 0) << submitted.text;
  coordinator_->stop(SIGKILL);
  start_coordinator();
  const Outcome fetched = command({"fetch", "shot", "--wait", "-o", path("f.####.exr"), "--timeout", "60"});
  EXPECT_EQ(fetched.code, 0) << fetched.text;
  for (const char* file : {"f.0001.exr", "f.0002.exr", "f.0003.exr"})
    EXPECT_TRUE(fs::exists(path(file))) << file;
}

TEST_F(FarmCommands, ControlJobs) {
  EXPECT_EQ(command(job("a", {"--samples", "16"})).code, 0);
  EXPECT_EQ(command(job("b", {"--samples", "16", "--after", "a"})).code, 0);
  EXPECT_EQ(command({"pause", "a"}).code, 0);
  EXPECT_EQ(state_of("a")["state"], "paused");
  EXPECT_EQ(command({"priority", "a", "80"}).code, 0);
  EXPECT_EQ(state_of("a")["priority"], 80);
  EXPECT_EQ(command({"resume", "a"}).code, 0);
  EXPECT_EQ(command({"cancel", "a"}).code, 0);
  EXPECT_EQ(state_of("a")["state"], "cancelled");
  const Outcome waited = command({"fetch", "b", "--wait", "-o", path("b.exr")});
  EXPECT_EQ(waited.code, 7) << waited.text;
  EXPECT_THAT(waited.text, HasSubstr("comes after a, which was cancelled"));
  EXPECT_THAT(command({"jobs"}).text, HasSubstr("no jobs under way"));
  EXPECT_THAT(command({"jobs", "--all"}).text, HasSubstr("cancelled"));
}

TEST_F(FarmCommands, SayWhatIsWrong) {
  EXPECT_EQ(command({"jobs", "nobody"}).code, 3);
  EXPECT_EQ(command({"cancel", "nobody"}).code, 3);
  EXPECT_EQ(command({"submit", path("missing.json")}).code, 3);
  EXPECT_EQ(command({"release", "nobody"}).code, 0) << "it is not set aside";
  const Outcome away = run({"jobs", "--coordinator", "ipc://" + path("nowhere"), "--timeout", "0.3"});
  EXPECT_EQ(away.code, 6) << away.text;
  const Outcome second =
      run({"coordinator", "--listen", "ipc://" + path("other"), "--store", path("store"), "--http", "none"});
  EXPECT_EQ(second.code, 2) << second.text;
  const Outcome open =
      run({"coordinator", "--listen", "0.0.0.0:0", "--store", path("store2"), "--http", "none"});
  EXPECT_EQ(open.code, 2) << open.text;
  EXPECT_THAT(open.text, HasSubstr("keygen"));
}

TEST_F(FarmCommands, LeaveWhenTheyAreTold) {
  hire("one");
  EXPECT_EQ(command(job("long", {"--samples", "4096"})).code, 0);
  const Outcome worker = workers_.back()->stop(SIGTERM);
  EXPECT_EQ(worker.code, 0) << worker.text;
  const Outcome coordinator = coordinator_->stop(SIGTERM);
  EXPECT_EQ(coordinator.code, 0) << coordinator.text;
}

}  // namespace
}  // namespace tessera
