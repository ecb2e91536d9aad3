// SPDX-License-Identifier: Apache-2.0
// tessera worker: works for a farm until it is told to stop.
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <array>
#include <condition_variable>
#include <cstdlib>
#include <filesystem>
#include <memory>
#include <mutex>

#include "cli/farm_link.h"
#include "cli/key_watch.h"
#include "cli/limit_options.h"
#include "cli/local_farm.h"
#include "cli/log_options.h"
#include "cli/service_signals.h"
#include "cli/subcommand.h"
#include "cli/version.h"
#include "worker/bundle_source.h"
#include "worker/task_runner.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

struct WorkerCommand {
  LinkOptions link;
  std::vector<std::string> devices;
  std::optional<int> threads;
  std::string name, cache;
  std::uint64_t cache_size = 20'480, texture_memory = 1024;  // MiB
  double grace = 10;                                         // seconds
  ImportLimits limits;
  LogOptions log{.level = "info"};
};

std::string host_name() {
  std::array<char, 256> name{};
  return gethostname(name.data(), name.size() - 1) == 0 && name[0] != 0 ? name.data() : "worker";
}

fs::path cache_folder(const std::string& asked) {
  if (!asked.empty()) return asked;
  if (const char* cache = std::getenv("XDG_CACHE_HOME"); cache && *cache) return fs::path(cache) / "tessera";
  if (const char* home = std::getenv("HOME"); home && *home) return fs::path(home) / ".cache" / "tessera";
  return fs::temp_directory_path() / "tessera-cache";
}

// Ends the process when a leave takes longer than it may.
class Grace {
 public:
  explicit Grace(double seconds) : seconds_(seconds) {}
  ~Grace() { over(); }
  void begin() {
    const std::lock_guard lock(mutex_);
    if (thread_.joinable()) return;
    thread_ = std::jthread([this](const std::stop_token& token) {
      std::unique_lock wait(mutex_);
      const auto time = std::chrono::duration<double>(seconds_);
      if (!bell_.wait_for(wait, token, time, [this] { return over_; }) && !token.stop_requested()) {
        spdlog::warn("worker: ends at once: its tasks took longer than its grace of {} s", seconds_);
        _exit(static_cast<int>(ExitCode::done));
      }
    });
  }
  void over() {
    const std::lock_guard lock(mutex_);
    over_ = true;
    bell_.notify_all();
  }

 private:
  double seconds_;
  std::mutex mutex_;  // guards the next
  bool over_ = false;
  std::condition_variable_any bell_;
  std::jthread thread_;
};

int ending(const WorkerEnd& end) {
  if (end.why == Farewell::asked) return 0;
  spdlog::error("worker: {}", end.reason);
  return static_cast<int>(ExitCode::unreachable);
}

int run_worker(const WorkerCommand& c) {
  set_up_log(c.log);
  Grace grace(c.grace);
  ServiceSignals signals([&] { grace.begin(); });
  const std::string name = c.name.empty() ? host_name() : c.name, id = own_id(name);
  ZmqContext context;
  const auto keys = read_client_keys(c.link.keys);
  const auto road = road_to(context, c.link, id);
  std::optional<KeyWatch> watch;
  if (keys)
    watch.emplace(c.link.keys, *road, [](std::string_view what) { spdlog::info("worker: {}", what); });
  DevicePool devices = DevicePool::open(c.devices);
  const AgentOptions options{.slots = c.threads.value_or(usable_threads()),
                             .version = std::string(kVersion),
                             .device_class = device_class(std::string(kVersion), devices.infos()),
                             .name = name};
  const auto cache =
      std::make_shared<AssetCache>(AssetCacheOptions{cache_folder(c.cache), c.cache_size << 20});
  const auto connect = [&] { return std::make_unique<FarmClient>(road_to(context, c.link, own_id(name))); };
  const auto runner = make_task_runner(scenes_of_farm(cache, connect, c.limits), std::move(devices), 2,
                                       {.memory = c.texture_memory << 20});
  Worker works(options, *road, *runner);
  spdlog::info("worker: {} works for {} with {} slots on {}", name, c.link.coordinator, options.slots,
               options.device_class);
  WorkerEnd end;
  {
    const ServiceSignals::Reach reach(
        signals, [&] { works.stop(); },
        [&] {
          if (watch) watch->look();
        });
    end = works.run();
  }
  grace.over();
  return ending(end);
}

}  // namespace

std::function<int()> describe_worker(CLI::App& app) {
  auto c = std::make_shared<WorkerCommand>();
  add_link_options(app, c->link);
  app.add_option("--device", c->devices,
                 "OpenCL device: number or part of its name; several times: tiles go to each by its speed "
                 "[first CPU]")
      ->envname("TESSERA_DEVICE")
      ->delimiter(',');
  app.add_option("--threads", c->threads, "Tasks worked on at a time [what this process may use]")
      ->check(CLI::Range(1, 1024))
      ->envname("TESSERA_THREADS");
  app.add_option("--name", c->name, "What people and logs call it [the machine's name]")
      ->envname("TESSERA_NAME");
  app.add_option("--cache", c->cache, "Folder in which scenes are kept [~/.cache/tessera]")
      ->envname("TESSERA_CACHE");
  app.add_option("--cache-size", c->cache_size, "MiB of scenes to keep")
      ->envname("TESSERA_CACHE_SIZE")
      ->capture_default_str();
  app.add_option("--texture-memory", c->texture_memory, "MiB of textures held in memory")
      ->check(CLI::Range(std::uint64_t{16}, std::uint64_t{1} << 24))
      ->envname("TESSERA_TEXTURE_MEMORY")
      ->capture_default_str();
  app.add_option("--grace", c->grace, "Seconds in which it leaves when it is told to stop (SIGTERM)")
      ->check(CLI::Range(0.0, 3600.0))
      ->envname("TESSERA_GRACE")
      ->capture_default_str();
  add_limit_option(app, c->limits);
  add_log_options(app, c->log);
  return [c] { return run_worker(*c); };
}

}  // namespace tessera
