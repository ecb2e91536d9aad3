// SPDX-License-Identifier: Apache-2.0
#include "core/scene/json_text.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <nlohmann/json.hpp>

namespace tessera {
namespace {

constexpr std::size_t kLine = 110;

std::string number_text(double v) {
  if (v == 0) return std::signbit(v) ? "-0.0" : "0";
  const float f = static_cast<float>(v);
  if (static_cast<double>(f) == v) {
    std::string text = fmt::format("{}", f);
    if (static_cast<float>(std::strtod(text.c_str(), nullptr)) == f) return text;
  }
  return fmt::format("{}", v);
}

std::string quoted(const std::string& text) {
  return nlohmann::json(text).dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

// On one line.
std::string flat(const Json& json) {
  if (json.is_null()) return "null";
  if (json.is_boolean()) return json.boolean() ? "true" : "false";
  if (json.is_number()) return number_text(json.number());
  if (json.is_text()) return quoted(json.text());
  std::string inside;
  if (json.is_array()) {
    for (const Json& item : json.items()) inside += (inside.empty() ? "" : ", ") + flat(item);
    return "[" + inside + "]";
  }
  for (const auto& [key, value] : json.members())
    inside += (inside.empty() ? " " : ", ") + quoted(key) + ": " + flat(value);
  return "{" + inside + (inside.empty() ? "}" : " }");
}

// A container with this many values in it, at any depth, is not even tried on one line.
bool may_fit(const Json& json, std::size_t& room) {
  if (room == 0) return false;
  --room;
  if (json.is_array()) {
    for (const Json& item : json.items())
      if (!may_fit(item, room)) return false;
  } else if (json.is_object()) {
    for (const auto& [key, value] : json.members())
      if (!may_fit(value, room)) return false;
  }
  return true;
}

void append_text(std::string& text, const Json& json, std::size_t indent) {
  std::size_t room = kLine / 2;
  if (indent > 0 && may_fit(json, room)) {
    std::string line = flat(json);
    if (line.size() + indent <= kLine || !(json.is_array() || json.is_object())) {
      text += line;
      return;
    }
  }
  const std::string lead(indent + 2, ' ');
  bool first = true;
  const auto next = [&] {
    text += first ? "\n" : ",\n";
    text += lead;
    first = false;
  };
  text += json.is_array() ? '[' : '{';
  if (json.is_array())
    for (const Json& item : json.items()) next(), append_text(text, item, indent + 2);
  else
    for (const auto& [key, value] : json.members())
      next(), text += quoted(key) + ": ", append_text(text, value, indent + 2);
  text += '\n' + std::string(indent, ' ') + (json.is_array() ? ']' : '}');
}

}  // namespace

std::string json_text(const Json& json) {
  if (!json.is_array() && !json.is_object()) return flat(json) + '\n';
  std::string text;
  append_text(text, json, 0);
  return text + '\n';
}

}  // namespace tessera
