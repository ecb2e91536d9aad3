// SPDX-License-Identifier: Apache-2.0
#include "cli/limit_options.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <limits>
#include <optional>

#include "core/error.h"

namespace tessera {
namespace {

constexpr std::array<std::pair<std::string_view, std::uint64_t>, 7> kUnits{{{"", 1},
                                                                            {"k", 1000},
                                                                            {"M", 1000'000},
                                                                            {"G", 1000'000'000},
                                                                            {"Ki", 1ull << 10},
                                                                            {"Mi", 1ull << 20},
                                                                            {"Gi", 1ull << 30}}};

std::optional<std::uint64_t> whole_number(std::string_view text) {
  std::uint64_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc()) return std::nullopt;
  const std::string_view suffix(end, static_cast<std::size_t>(text.data() + text.size() - end));
  for (const auto& [unit, factor] : kUnits)
    if (unit == suffix && value <= std::numeric_limits<std::uint64_t>::max() / factor) return value * factor;
  return std::nullopt;
}

}  // namespace

void parse_limit(const std::string& text, ImportLimits& limits) {
  const std::size_t equals = text.find('=');
  const auto value =
      equals == std::string::npos ? std::nullopt : whole_number(std::string_view(text).substr(equals + 1));
  if (!value)
    throw Error(
        ExitCode::bad_usage,
        fmt::format("--limit: '{}' is not accepted; accepted: NAME=VALUE, where NAME is one of {} and "
                    "VALUE a whole number, with k, M, G, Ki, Mi or Gi after it",
                    text, fmt::join(limit_names(), ", ")));
  set_limit(limits, text.substr(0, equals), *value);
}

void add_limit_option(CLI::App& app, ImportLimits& limits) {
  app.add_option_function<std::vector<std::string>>(
         "--limit",
         [&limits](const std::vector<std::string>& all) {
           for (const std::string& one : all) parse_limit(one, limits);
         },
         fmt::format("Refuse scenes beyond NAME=VALUE, e.g. vertices=2M: {}", fmt::join(limit_names(), ", ")))
      ->allow_extra_args(false)
      ->multi_option_policy(CLI::MultiOptionPolicy::TakeAll);
}

}  // namespace tessera
