// SPDX-License-Identifier: Apache-2.0
// Filters as text, and the checks of plans that come from outside.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <charconv>
#include <cmath>
#include <utility>

#include "core/error.h"
#include "core/filter/filter.h"
#include "core/nearest.h"

namespace tessera {
namespace {

std::string suggestion(std::string_view word, std::span<const std::string_view> names) {
  const std::string_view meant = nearest(word, names);
  return fmt::format("{}; accepted: {}", meant.empty() ? "" : fmt::format("; did you mean '{}'?", meant),
                     fmt::join(names, ", "));
}

// What the user typed goes into messages, but not a megabyte of it.
std::string quoted(std::string_view text) {
  constexpr std::size_t kShown = 64;
  return fmt::format("'{}{}'", text.substr(0, kShown), text.size() > kShown ? "..." : "");
}

const FilterDescription& find_filter(std::string_view name, ExitCode code) {
  std::vector<std::string_view> names;
  for (const FilterDescription& d : filters()) {
    if (d.name == name) return d;
    names.push_back(d.name);
  }
  throw Error(code, fmt::format("unknown filter {}{}", quoted(name), suggestion(name, names)));
}

const Parameter& find_parameter(const FilterDescription& filter, std::string_view name, ExitCode code) {
  std::vector<std::string_view> names;
  for (const Parameter& p : filter.parameters) {
    if (p.name == name) return p;
    names.push_back(p.name);
  }
  if (names.empty())
    throw Error(code,
                fmt::format("filter '{}' has no parameters, so {} is unknown", filter.name, quoted(name)));
  throw Error(code, fmt::format("filter '{}' has no parameter {}{}", filter.name, quoted(name),
                                suggestion(name, names)));
}

std::string range(const Parameter& p) {
  if (!p.choices.empty()) return fmt::format("{}", fmt::join(p.choices, ", "));
  return fmt::format("{}{} to {}{}{}", p.integral ? "whole numbers from " : "", p.low, p.high,
                     p.unit.empty() || p.unit == "1" ? "" : " ", p.unit == "1" ? "" : p.unit);
}

bool in_range(const Parameter& p, double v) {
  return v >= p.low && v <= p.high && (!p.integral || v == std::floor(v));  // false for NaN
}

double parse_value(const FilterDescription& filter, const Parameter& p, std::string_view text) {
  for (std::size_t i = 0; i < p.choices.size(); ++i)
    if (p.choices[i] == text) return static_cast<double>(i);
  double value = 0;
  const auto [end, problem] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool number = problem == std::errc{} && end == text.data() + text.size() && !text.empty();
  if (p.choices.empty() && number && in_range(p, value)) return value;
  throw Error(ExitCode::bad_usage, fmt::format("filter '{}': {}={} is not accepted; accepted: {}",
                                               filter.name, p.name, quoted(text), range(p)));
}

std::string value_text(const Parameter& p, double value) {
  return p.choices.empty() ? fmt::format("{}", value)
                           : std::string(p.choices[static_cast<std::size_t>(value)]);
}

// Cuts `text` at the first `mark`; what follows it is left in `text`.
std::string_view take_until(std::string_view& text, char mark) {
  const std::size_t at = text.find(mark);
  const std::string_view head = text.substr(0, at);
  text = at == std::string_view::npos ? std::string_view{} : text.substr(at + 1);
  return head;
}

}  // namespace

FilterPlan parse_filter(std::string_view text) {
  const bool has_parameters = text.find(':') != std::string_view::npos;
  const FilterDescription& filter = find_filter(take_until(text, ':'), ExitCode::bad_usage);
  FilterPlan plan{std::string(filter.name), {}};
  ParameterValues given;
  while (has_parameters && (!text.empty() || given.empty())) {
    std::string_view value = take_until(text, ',');
    const bool assigned = value.find('=') != std::string_view::npos;
    const Parameter& p = find_parameter(filter, take_until(value, '='), ExitCode::bad_usage);
    if (!assigned)
      throw Error(ExitCode::bad_usage,
                  fmt::format("filter '{}': {} needs a value, as in {}={}; accepted: {}", filter.name, p.name,
                              p.name, value_text(p, p.standard), range(p)));
    if (!given.emplace(p.name, parse_value(filter, p, value)).second)
      throw Error(ExitCode::bad_usage, fmt::format("filter '{}': {} is given twice", filter.name, p.name));
  }
  for (const Parameter& p : filter.parameters) given.emplace(p.name, p.standard);
  plan.parameters = std::move(given);
  return plan;
}

std::string to_string(const FilterPlan& plan) {
  std::string text = plan.name;
  char separator = ':';
  for (const Parameter& p : plan.description().parameters) {
    const double value = plan[p.name];
    if (value == p.standard) continue;
    text += fmt::format("{}{}={}", std::exchange(separator, ','), p.name, value_text(p, value));
  }
  return text;
}

void validate(const FilterPlan& plan) {
  const FilterDescription& filter = find_filter(plan.name, ExitCode::bad_input);
  for (const auto& [name, value] : plan.parameters) {
    const Parameter& p = find_parameter(filter, name, ExitCode::bad_input);
    if (!in_range(p, value))
      throw Error(ExitCode::bad_input, fmt::format("filter '{}': {}={} is not accepted; accepted: {}",
                                                   filter.name, name, value, range(p)));
  }
  for (const Parameter& p : filter.parameters)
    if (!plan.parameters.contains(p.name))
      throw Error(ExitCode::bad_input,
                  fmt::format("filter '{}': {} is missing; accepted: {}", filter.name, p.name, range(p)));
}

}  // namespace tessera
