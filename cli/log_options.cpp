// SPDX-License-Identifier: Apache-2.0
#include "cli/log_options.h"

#include <spdlog/pattern_formatter.h>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>

#include <array>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace tessera {
namespace {

constexpr std::array kLevels{"debug", "info", "warning", "error"};
constexpr std::array kFormats{"text", "json"};

std::string json_text(std::string_view text) {  // bytes that are no UTF-8 are replaced
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// "component: message" as two fields of a JSON object; a message alone as one.
class JsonFields : public spdlog::custom_flag_formatter {
 public:
  void format(const spdlog::details::log_msg& message, const std::tm&, spdlog::memory_buf_t& to) override {
    const std::string_view all(message.payload.data(), message.payload.size());
    const std::size_t end = all.find_first_not_of("abcdefghijklmnopqrstuvwxyz");
    const bool parted = end != 0 && end != all.npos && all.substr(end).starts_with(": ");
    const std::string fields = parted ? R"("component":)" + json_text(all.substr(0, end)) + R"(,"message":)" +
                                            json_text(all.substr(end + 2))
                                      : R"("message":)" + json_text(all);
    to.append(fields.data(), fields.data() + fields.size());
  }
  std::unique_ptr<custom_flag_formatter> clone() const override { return std::make_unique<JsonFields>(); }
};

std::unique_ptr<spdlog::formatter> json_lines() {
  auto lines = std::make_unique<spdlog::pattern_formatter>(spdlog::pattern_time_type::utc);
  lines->add_flag<JsonFields>('*').set_pattern(R"({"time":"%Y-%m-%dT%H:%M:%S.%eZ","level":"%l",%*})");
  return lines;
}

}  // namespace

void add_log_options(CLI::App& app, LogOptions& o) {
  app.add_flag("-v,--verbose", o.verbose, "Same as --log-level info");
  app.add_option("--log-level", o.level, "To stderr")
      ->check(CLI::IsMember(std::vector<std::string>(kLevels.begin(), kLevels.end())))
      ->envname("TESSERA_LOG_LEVEL")
      ->capture_default_str();
  app.add_option("--log-format", o.format, "text, or an object of JSON a line")
      ->check(CLI::IsMember(std::vector<std::string>(kFormats.begin(), kFormats.end())))
      ->envname("TESSERA_LOG_FORMAT")
      ->capture_default_str();
}

void set_up_log(const LogOptions& o) {
  auto log = std::make_shared<spdlog::logger>("tessera", std::make_shared<spdlog::sinks::stderr_sink_mt>());
  log->set_level(spdlog::level::from_str(o.verbose && o.level == "warning" ? "info" : o.level));
  if (o.format == "json")
    log->set_formatter(json_lines());
  else
    log->set_pattern("%Y-%m-%dT%H:%M:%S.%eZ %l %v", spdlog::pattern_time_type::utc);
  spdlog::set_default_logger(std::move(log));
}

}  // namespace tessera
