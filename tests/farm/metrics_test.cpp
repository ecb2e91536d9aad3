// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/metrics.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <regex>
#include <set>
#include <sstream>

#include "coordinator/farm/http.h"

namespace tessera {
namespace {

using testing::HasSubstr;

FarmFigures busy() {
  FarmFigures f{.version = "1.2", .pixel_samples = 12'345'678'901, .wrong_bits = 3};
  f.tasks.assigned = 7;
  f.jobs[static_cast<std::size_t>(JobState::active)] = 2;
  f.active = {{.job = "atrium", .fraction = 0.25, .error = 0.01, .target = 0.0025}, {.job = "a\"\\\nb"}};
  f.router.refused_keys = 4;
  return f;
}

TEST(Metrics, EveryLineIsWhatPrometheusReads) {
  const std::regex help("# HELP tessera_[a-z_]+ [^\\n]+"), type("# TYPE tessera_[a-z_]+ (gauge|counter)"),
      sample(R"re(tessera_[a-z_]+(\{[a-z_]+="([^"\\]|\\["\\n])*"\})? [0-9.e+-]+)re");
  std::istringstream lines(metrics_text(busy()));
  int samples = 0;
  for (std::string line; std::getline(lines, line); samples += line[0] != '#')
    EXPECT_TRUE(std::regex_match(line, help) || std::regex_match(line, type) ||
                std::regex_match(line, sample))
        << line;
  EXPECT_GT(samples, 40);
  EXPECT_EQ(metrics_text(busy()).back(), '\n');
}

TEST(Metrics, EachNameIsDescribedOnceBeforeItsSamplesAndCountersEndInTotal) {
  std::istringstream lines(metrics_text(busy()));
  std::set<std::string> described;
  std::string current;
  for (std::string line; std::getline(lines, line);) {
    std::istringstream words(line);
    std::string hash, what, name, kind;
    if (line.starts_with("# TYPE")) {
      words >> hash >> what >> current >> kind;
      EXPECT_TRUE(described.insert(current).second) << current;
      EXPECT_EQ(kind == "counter", current.ends_with("_total")) << current;
    } else if (line[0] != '#') {
      EXPECT_EQ(line.substr(0, line.find_first_of("{ ")), current);
    }
  }
}

TEST(Metrics, SayTheFigures) {
  const std::string text = metrics_text(busy());
  for (const char* line :
       {"tessera_build_info{version=\"1.2\"} 1\n", "tessera_tasks_assigned_total 7\n",
        "tessera_pixel_samples_total 12345678901\n", "tessera_jobs{state=\"active\"} 2\n",
        "tessera_job_relmse{job=\"atrium\"} 0.01\n", "tessera_job_fraction{job=\"a\\\"\\\\\\nb\"} 0\n",
        "tessera_connections_refused_total{reason=\"key\"} 4\n", "tessera_verify_other_bits_total 3\n"})
    EXPECT_THAT(text, HasSubstr(line));
}

TEST(Health, IsBadBeforeTheFirstFiguresWhileThereIsTroubleAndWhenTheLoopIsStuck) {
  const Instant now{std::chrono::seconds(100)};
  FigureBoard board;
  EXPECT_THAT(health_trouble(board.last(), now), HasSubstr("not begun"));
  board.post(std::make_shared<FarmFigures>(), now);
  EXPECT_EQ(health_trouble(board.last(), now + Millis(4900)), "");
  EXPECT_THAT(health_trouble(board.last(), now + Millis(6000)), HasSubstr("not turned for 6 s"));
  board.post(std::make_shared<FarmFigures>(FarmFigures{.trouble = "disk full"}), now);
  EXPECT_EQ(health_trouble(board.last(), now), "disk full");
}

TEST(Http, IsFoundOnThisMachineOnly) {
  const FigureBoard board;
  const auto now = [] { return Instant{}; };
  for (const char* host : {"0.0.0.0", "192.168.1.1", "::", "example.org", "128.0.0.1"}) try {
      const HttpServer server(host, 0, board, now);
      ADD_FAILURE() << host;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_usage) << host;
    }
  const HttpServer server("127.0.0.1", 0, board, now);
  EXPECT_GT(server.port(), 0);
  EXPECT_THROW(HttpServer("127.0.0.1", server.port(), board, now), Error) << "a port is not shared";
}

}  // namespace
}  // namespace tessera
