// SPDX-License-Identifier: Apache-2.0
#include "cli/farm_link.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

#include <algorithm>
#include <random>

#include "core/submission.h"
#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kUsual{500};  // within which a coordinator that is there is connected to

}  // namespace

void add_link_options(CLI::App& app, LinkOptions& o) {
  app.add_option("--coordinator", o.coordinator, "HOST:PORT of the farm's coordinator, or ipc://PATH")
      ->envname("TESSERA_COORDINATOR")
      ->capture_default_str();
  app.add_option("--timeout", o.timeout, "Seconds to wait for an answer")
      ->check(CLI::Range(0.1, 86'400.0))
      ->envname("TESSERA_TIMEOUT")
      ->capture_default_str();
  add_client_key_options(app, o.keys);
}

std::string own_id(const std::string& word) {
  std::string id;
  for (const char c : word.substr(0, 40)) id += is_job_name(std::string{'a', c}) ? c : '_';
  if (!id.empty() && id.front() == '.') id.front() = '_';
  std::random_device chance;
  return fmt::format("{}-{:08x}{:08x}", id, chance(), chance());
}

std::unique_ptr<ZmqDealer> road_to(ZmqContext& context, const LinkOptions& o, const std::string& id) {
  ZmqOptions road;
  road.on_dropped = [](std::string_view why) { spdlog::warn("dropped: {}", why); };
  auto dealer = std::make_unique<ZmqDealer>(context, endpoint_of("--coordinator", o.coordinator, false), id,
                                            road, read_client_keys(o.keys));
  dealer->await(clock_now() + kUsual);
  return dealer;
}

FarmClient::Progress upload_bar(bool quiet) {
  if (quiet || isatty(STDERR_FILENO) == 0) return {};
  return [](std::uint64_t done, std::uint64_t all) {
    fmt::print(stderr, "\rupload {:>5.1f} %{}",
               all ? 100.0 * static_cast<double>(done) / static_cast<double>(all) : 100.0,
               done == all ? "\n" : "");
  };
}

FarmLink::FarmLink(const LinkOptions& o)
    : client_(road_to(context_, o, own_id("client")),
              {.patience = Millis(static_cast<std::int64_t>(o.timeout * 1000))}) {}

}  // namespace tessera
