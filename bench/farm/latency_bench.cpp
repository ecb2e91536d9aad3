// SPDX-License-Identifier: Apache-2.0
// How long `tessera submit SCENE --output FILE` takes to an image in a file, beyond the time for which the
// frame is worked on: on a farm that is there and has the scene. The command runs within this process, again
// and again, so starting a process is not in it; what that takes is told beside it. bench/farm/processes.sh
// starts the farm.
//   TESSERA_COORDINATOR=... latency_bench JOBS FOLDER SCENE [OPTIONS of submit]
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "cli/farm_link.h"
#include "cli/subcommand.h"

namespace tessera {
namespace {

constexpr double kGoal = 0.150;

double seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// `words` as they would stand behind `tessera`.
void command(std::function<int()> (*describe)(CLI::App&), std::vector<std::string> words) {
  CLI::App app;
  const std::function<int()> run = describe(app);
  std::ranges::reverse(words);  // CLI11 takes them so
  app.parse(words);
  if (const int code = run()) throw std::runtime_error(fmt::format("exit code {}", code));
}

struct Sample {
  double wall = 0, frame = 0;
  double beyond() const { return wall - frame; }
};

Sample sample(FarmLink& farm, const std::string& job, const std::string& file,
              std::vector<std::string> words) {
  words.insert(words.end(), {"--job", job, "--quiet", "--output", file});
  Sample s;
  s.wall = seconds([&] { command(describe_submit, words); });
  s.frame = farm.ask<JobDetail>(ShowJob{job, 0}).frames.at(0).seconds;
  if (!std::filesystem::exists(file)) throw std::runtime_error(file + " is not there");
  return s;
}

double median(std::vector<double> v) {
  std::ranges::sort(v);
  return v[v.size() / 2];
}

int run(int jobs, const std::string& folder, const std::vector<std::string>& words) {
  LinkOptions link;
  if (const char* at = std::getenv("TESSERA_COORDINATOR")) link.coordinator = at;
  FarmLink farm(link);
  const std::string name = own_id("latency");
  std::vector<double> wall, frame, beyond;
  for (int i = -1; i < jobs; ++i) {  // the first one warms the farm
    const Sample s =
        sample(farm, fmt::format("{}.{}", name, i + 1), fmt::format("{}/{}.exr", folder, i + 1), words);
    if (i < 0) continue;
    wall.push_back(s.wall);
    frame.push_back(s.frame);
    beyond.push_back(s.beyond());
  }
  fmt::print(
      "{} jobs, medians: submit to file {:.0f} ms, the frame {:.0f} ms, beyond it {:.0f} ms (least {:.0f}, "
      "most"
      " {:.0f}); goal: at most {:.0f}\n",
      jobs, 1e3 * median(wall), 1e3 * median(frame), 1e3 * median(beyond),
      1e3 * *std::ranges::min_element(beyond), 1e3 * *std::ranges::max_element(beyond), 1e3 * kGoal);
  return 0;
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  if (count < 4) {
    fmt::print("latency_bench: needs a farm; bench/farm/processes.sh starts one\n");
    return 0;
  }
  try {
    return tessera::run(std::atoi(words[1]), words[2], {words + 3, words + count});
  } catch (const std::exception& e) {
    fmt::print(stderr, "latency_bench: {}\n", e.what());
    return 1;
  }
}
