// SPDX-License-Identifier: Apache-2.0
// tessera coordinator: a farm's centre, as a service.
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <filesystem>
#include <memory>
#include <optional>

#include "cli/endpoint.h"
#include "cli/key_options.h"
#include "cli/key_watch.h"
#include "cli/log_options.h"
#include "cli/service_signals.h"
#include "cli/subcommand.h"
#include "cli/version.h"
#include "coordinator/farm/farm.h"
#include "coordinator/farm/http.h"
#include "proto/clock.h"
#include "proto/zmq_transport.h"

namespace tessera {
namespace {

struct CoordinatorCommand {
  std::vector<std::string> listen{std::string(kFarmAddress)};
  std::string store = "tessera-store";
  std::uint64_t memory = 0;       // MiB; 0: half of what there is
  std::uint64_t store_limit = 0;  // MiB; 0: as much as the disk has
  std::string http{kHttpAddress};
  bool http_asked = false;  // for that address
  double silence = 10;      // seconds
  int failures = SchedulerOptions{}.max_attempts;
  KeyFiles keys;
  LogOptions log{.level = "info"};
};

double memory_of(const CoordinatorCommand& c) {
  if (c.memory > 0) return static_cast<double>(c.memory) * (1 << 20);
  return 0.5 * static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
}

FarmOptions options_of(const CoordinatorCommand& c) {
  FarmOptions options{.store = c.store, .memory = memory_of(c), .version = std::string(kVersion)};
  SchedulerOptions& scheduler = options.coordinator.scheduler;
  scheduler.silence = Millis(static_cast<std::int64_t>(c.silence * 1000));
  scheduler.grace = std::min(scheduler.grace, scheduler.silence / 2);
  scheduler.max_attempts = c.failures;
  options.coordinator.heartbeat = std::min(Millis(1000), scheduler.silence / 5);
  if (c.store_limit > 0) options.blobs.most = c.store_limit << 20;
  return options;
}

// A coordinator is no worse for a second one beside it that has the usual port.
std::unique_ptr<HttpServer> open_http(const CoordinatorCommand& c, const FigureBoard& board) try {
  if (c.http == "none") return nullptr;
  const HostPort at = parse_host_port("--http", c.http, parse_host_port("--http", kHttpAddress, 0).port);
  auto server = std::make_unique<HttpServer>(at.host, at.port, board, clock_now);
  spdlog::info("coordinator: http://{}:{}/metrics and /healthz", c.http.substr(0, c.http.rfind(':')),
               server->port());
  return server;
} catch (const Error& e) {
  if (c.http_asked || e.code() != ExitCode::unreachable) throw;
  spdlog::warn("coordinator: {}; there are no metrics", e.what());
  return nullptr;
}

int run_coordinator(const CoordinatorCommand& c) {
  set_up_log(c.log);
  ServiceSignals signals;
  std::vector<std::string> endpoints;
  for (const std::string& address : c.listen) endpoints.push_back(endpoint_of("--listen", address, true));
  ZmqContext context(2);
  ZmqOptions road{.high_water = 100'000};
  road.on_dropped = [](std::string_view why) { spdlog::warn("coordinator: dropped: {}", why); };
  const auto keys = read_server_keys(c.keys);
  ZmqRouter router(context, endpoints, road, keys);
  std::optional<KeyWatch> watch;
  if (keys)
    watch.emplace(c.keys, router, [](std::string_view what) { spdlog::warn("coordinator: {}", what); });
  FigureBoard board;
  FarmOptions options = options_of(c);
  options.publish = [&](FarmFigures figures) {
    figures.router = router.counts();
    board.post(std::make_shared<const FarmFigures>(std::move(figures)), clock_now());
  };
  Farm service(router, std::move(options));
  const auto http = open_http(c, board);
  spdlog::info("coordinator: tessera {} listens on {}{}", kVersion, fmt::join(router.endpoints(), ", "),
               keys ? ", with keys" : "");
  {
    const ServiceSignals::Reach reach(
        signals, [&] { service.stop(); },
        [&] {
          if (watch) watch->look();
        });
    service.run();
  }
  spdlog::info("coordinator: ends; its jobs go on when it is started again");
  return 0;
}

}  // namespace

std::function<int()> describe_coordinator(CLI::App& app) {
  auto c = std::make_shared<CoordinatorCommand>();
  app.add_option("--listen", c->listen,
                 "HOST:PORT or ipc://PATH, several times if need be; beyond this machine only with keys")
      ->envname("TESSERA_LISTEN")
      ->delimiter(',')
      ->capture_default_str();
  app.add_option("--store", c->store, "Folder in which jobs, scenes and images are kept")
      ->envname("TESSERA_STORE")
      ->capture_default_str();
  app.add_option("--memory", c->memory, "MiB that frames under way may take [half of this machine's]")
      ->envname("TESSERA_MEMORY");
  app.add_option("--store-limit", c->store_limit, "MiB of scenes and images to keep at most [no limit]")
      ->envname("TESSERA_STORE_LIMIT");
  CLI::Option* http =
      app.add_option("--http", c->http,
                     "HOST:PORT of this machine for GET /metrics (Prometheus) and /healthz; none: neither")
          ->envname("TESSERA_HTTP")
          ->capture_default_str();
  app.add_option("--silence", c->silence, "Seconds without a word after which a worker is given up")
      ->check(CLI::Range(0.2, 3600.0))
      ->envname("TESSERA_SILENCE")
      ->capture_default_str();
  app.add_option("--failures", c->failures, "Workers that may fail a task before its job fails")
      ->check(CLI::Range(1, 100))
      ->envname("TESSERA_FAILURES")
      ->capture_default_str();
  add_server_key_options(app, c->keys);
  add_log_options(app, c->log);
  return [c, http] {
    c->http_asked = http->count() > 0;
    return run_coordinator(*c);
  };
}

}  // namespace tessera
