// SPDX-License-Identifier: Apache-2.0
#include "core/scene/json.h"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>
#include <unordered_set>

#include "core/error.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxDepth = 64;

std::string line_and_column(std::string_view text, std::size_t offset) {
  const std::string_view before = text.substr(0, std::min(offset, text.size()));
  const auto line = 1 + std::count(before.begin(), before.end(), '\n');
  const std::size_t start = before.rfind('\n');
  const std::size_t column = before.size() - (start == std::string_view::npos ? 0 : start + 1);
  return fmt::format("{}:{}", line, std::max<std::size_t>(column, 1));
}

// Builds a Json from the events of nlohmann's parser.
class Builder : public nlohmann::json_sax<nlohmann::json> {
 public:
  Builder(std::string_view text, const std::string& file) : text_(text), file_(file) {}
  Json take() { return std::move(root_); }

  bool null() override { return place(), true; }
  bool boolean(bool v) override { return add(v); }
  bool number_integer(number_integer_t v) override { return add(static_cast<double>(v)); }
  bool number_unsigned(number_unsigned_t v) override { return add(static_cast<double>(v)); }
  bool number_float(number_float_t v, const string_t&) override { return add(v); }
  bool string(string_t& v) override { return add(std::move(v)); }
  bool binary(binary_t&) override { return false; }
  bool start_object(std::size_t) override { return open<Json::Object>(); }
  bool start_array(std::size_t) override { return open<Json::Array>(); }
  bool end_object() override { return close(); }
  bool end_array() override { return close(); }

  bool key(string_t& name) override {
    if (!keys_.back().insert(name).second)
      throw InputError(file_ + ":" + pointer(), "the key '" + name + "' is there twice");
    std::get<Json::Object>(open_.back()->value).emplace_back().first = std::move(name);
    return true;
  }

  bool parse_error(std::size_t position, const std::string&, const nlohmann::detail::exception& e) override {
    throw InputError(file_ + ":" + line_and_column(text_, position), reason(e.what()), "JSON (RFC 8259)");
  }

 private:
  // Without nlohmann's "[json.exception.parse_error.101] parse error at line 3, column 5: ".
  static std::string reason(std::string what) {
    if (const std::size_t end = what.find("] "); end != std::string::npos) what.erase(0, end + 2);
    if (const std::size_t end = what.find(": "); what.starts_with("parse error") && end != std::string::npos)
      what.erase(0, end + 2);
    return what;
  }

  // A null where the next value belongs, to be given its value there.
  Json& place() {
    if (open_.empty()) return root_;
    if (auto* items = std::get_if<Json::Array>(&open_.back()->value)) return items->emplace_back();
    return std::get<Json::Object>(open_.back()->value).back().second;
  }
  template <class Value>
  bool add(Value value) {
    place().value.emplace<Value>(std::move(value));
    return true;
  }
  template <class Container>
  bool open() {
    if (open_.size() == kMaxDepth)
      throw InputError(file_ + ":" + pointer(), fmt::format("nested deeper than {}", kMaxDepth));
    open_.push_back(&place());
    open_.back()->value.emplace<Container>();
    keys_.emplace_back();
    return true;
  }
  bool close() {
    open_.pop_back();
    keys_.pop_back();
    return true;
  }

  std::string pointer() const {
    std::string p;
    for (const Json* level : open_) {
      if (level == open_.back()) break;
      if (level->is_array()) p = pointer_to(p, level->items().size() - 1);
      if (level->is_object()) p = pointer_to(p, level->members().back().first);
    }
    return p.empty() ? "/" : p;
  }

  std::string_view text_;
  const std::string& file_;
  Json root_;
  // From the root to the innermost open container. Stable: a container grows only while it is the innermost.
  std::vector<Json*> open_;
  std::vector<std::unordered_set<std::string>> keys_;  // those met so far, of each open container
};

}  // namespace

const Json* Json::find(std::string_view key) const {
  const auto* object = std::get_if<Object>(&value);
  if (!object) return nullptr;
  const auto it = std::find_if(object->begin(), object->end(), [&](const auto& m) { return m.first == key; });
  return it == object->end() ? nullptr : &it->second;
}

Json parse_json(std::string_view text, const std::string& file) {
  Builder builder(text, file);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.take();
}

std::string pointer_to(const std::string& pointer, std::string_view key) {
  std::string p = pointer + '/';
  for (const char c : key) {
    if (c == '~')
      p += "~0";
    else if (c == '/')
      p += "~1";
    else
      p += c;
  }
  return p;
}

std::string pointer_to(const std::string& pointer, std::size_t index) {
  return pointer + '/' + std::to_string(index);
}

}  // namespace tessera
