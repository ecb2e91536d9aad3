// SPDX-License-Identifier: Apache-2.0
// A farm as people run it: processes that find each other over a socket, and commands.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include <future>
#include <memory>
#include <nlohmann/json.hpp>
#include <random>
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
  // Noise, as another renderer may have written it.
  std::string noisy(const std::string& name, int edge, unsigned seed) const {
    ExrImage picture;
    for (const char* channel : {"R", "G", "B", "Z"}) picture.channels.push_back({channel, ExrType::float32});
    picture.pixels = Image({0, 0, edge, edge}, 4);
    std::minstd_rand random(seed);
    for (float& v : picture.pixels.data()) v = std::uniform_real_distribution<float>(0.1f, 1)(random);
    write_exr(path(name), picture);
    return path(name);
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
  EXPECT_EQ(command({"remove", "a"}).code, 2) << "it is not over";
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
  EXPECT_EQ(command({"remove", "a"}).code, 0);
  EXPECT_EQ(command({"jobs", "a"}).code, 3);
}

TEST_F(FarmCommands, DenoiseThroughAFarmWhereTheyAreToldTo) {
  hire("one");
  const std::string in = noisy("in.exr", 96, 1), filter = "bilateral";
  setenv("TESSERA_COORDINATOR", ("ipc://" + path("nowhere")).c_str(), 1);
  setenv("TESSERA_DEVICE", "0", 1);
  const Outcome here = run({"denoise", in, "-o", path("here.exr"), "--filter", filter});
  const Outcome there = command({"denoise", in, "-o", path("there.exr"), "--filter", filter});
  unsetenv("TESSERA_COORDINATOR");
  unsetenv("TESSERA_DEVICE");
  EXPECT_EQ(here.code, 0) << here.text << "nobody is asked";
  EXPECT_THAT(here.text, Not(HasSubstr("farm")));
  ASSERT_EQ(there.code, 0) << there.text;
  EXPECT_TRUE(same_bits(read_exr(path("here.exr")).pixels, read_exr(path("there.exr")).pixels));
  const auto begin = there.text.find("job ") + 4;
  const std::string name = there.text.substr(begin, there.text.find(':', begin) - begin);
  EXPECT_EQ(state_of(name)["state"], "completed") << there.text;
  const Outcome verified = command({"verify", name});
  EXPECT_EQ(verified.code, 2);
  EXPECT_THAT(verified.text, HasSubstr("filters what it was given"));
  EXPECT_EQ(command({"fetch", name, "-o", path("fetched.exr")}).code, 0);
  EXPECT_EQ(read_exr(path("fetched.exr")).channels.size(), 3u);
  const Outcome device = command({"denoise", in, "-o", path("out.exr"), "--device", "0"});
  EXPECT_EQ(device.code, 2) << device.text;
}

TEST_F(FarmCommands, DenoiseToTheSameBitsThoughTheCoordinatorIsKilled) {
  hire("one");
  for (unsigned f = 1; f <= 3; ++f) noisy("in." + std::to_string(f) + ".exr", 160, f);
  const std::vector<std::string> words{"denoise", path("in.#.exr"), "--filter", "bilateral", "-o"};
  auto here = words, there = words;
  here.push_back(path("here.#.exr"));
  there.insert(there.end(), {path("there.#.exr"), "--tile-size", "16", "--coordinator", address_});
  ASSERT_EQ(run(here).code, 0);
  int kills = 0;
  const Outcome outcome = run(there, [&](pid_t, const std::string& line) {
    if (line.find("active") == line.npos || kills > 0) return;
    ++kills;
    coordinator_->stop(SIGKILL);
    start_coordinator();
  });
  EXPECT_EQ(outcome.code, 0) << outcome.text;
  EXPECT_EQ(kills, 1) << outcome.text;
  for (const char* f : {"1", "2", "3"})
    EXPECT_TRUE(same_bits(read_exr(path(std::string("here.") + f + ".exr")).pixels,
                          read_exr(path(std::string("there.") + f + ".exr")).pixels));
}

TEST_F(FarmCommands, SayWhatIsWrong) {
  EXPECT_THAT(command(job("few", {"--samples", "1"})).text, HasSubstr("--samples 1: at least 8 are taken"));
  const Outcome many = command(job("many", {"--frames", "0-999999"}));
  EXPECT_EQ(many.code, 2) << many.text;
  EXPECT_THAT(many.text, HasSubstr("accepted: at most 100000 frames"));
  EXPECT_EQ(command({"jobs", "nobody"}).code, 3);
  EXPECT_EQ(command({"cancel", "nobody"}).code, 3);
  EXPECT_EQ(command({"remove", "nobody"}).code, 3);
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
