// SPDX-License-Identifier: Apache-2.0
#include "core/scene/schema.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>

#include "core/error.h"
#include "core/nearest.h"

namespace tessera {
namespace {

// Keywords that say nothing about what is accepted, and those that are looked at with another one.
constexpr std::array<std::string_view, 6> kSilent{"$schema", "title",       "description",
                                                  "default", "definitions", "examples"};

const Json& resolved(const Json& schema, const Json& root) {
  const Json* ref = schema.find("$ref");
  if (!ref) return schema;
  constexpr std::string_view prefix = "#/definitions/";
  const Json* definitions = root.find("definitions");
  const std::string_view name = ref->text();
  const Json* target =
      definitions && name.starts_with(prefix) ? definitions->find(name.substr(prefix.size())) : nullptr;
  if (!target) throw std::logic_error("schema: no " + ref->text());
  return resolved(*target, root);
}

std::vector<std::string_view> types_of(const Json& schema) {
  const Json* type = schema.find("type");
  if (!type) return {};
  if (type->is_text()) return {type->text()};
  std::vector<std::string_view> types;
  for (const Json& t : type->items()) types.push_back(t.text());
  return types;
}

bool is_a(const Json& value, std::string_view type) {
  if (type == "object") return value.is_object();
  if (type == "array") return value.is_array();
  if (type == "string") return value.is_text();
  if (type == "number") return value.is_number();
  if (type == "integer") return value.is_number() && std::trunc(value.number()) == value.number();
  if (type == "boolean") return value.is_boolean();
  if (type == "null") return value.is_null();
  throw std::logic_error(fmt::format("schema: unknown type {}", type));
}

std::vector<std::string_view> names_of(const Json& list) {
  std::vector<std::string_view> names;
  for (const Json& name : list.items()) names.push_back(name.text());
  return names;
}

std::vector<std::string_view> keys_of(const Json& schema) {
  std::vector<std::string_view> keys;
  if (const Json* properties = schema.find("properties"))
    for (const auto& [key, value] : properties->members()) keys.push_back(key);
  return keys;
}

// The words of a pattern "^(one|other)$", the only kind we use.
std::vector<std::string_view> words_of(const Json& pattern) {
  std::string_view text = pattern.text();
  if (!text.starts_with("^(") || !text.ends_with(")$"))
    throw std::logic_error(fmt::format("schema: unknown pattern {}", text));
  text = text.substr(2, text.size() - 4);
  std::vector<std::string_view> words;
  for (std::size_t bar = 0; bar != std::string_view::npos; text.remove_prefix(bar + 1)) {
    bar = text.find('|');
    words.push_back(text.substr(0, bar));
    if (bar == std::string_view::npos) break;
  }
  return words;
}

std::string range_in_words(const Json& schema) {
  const Json *low = schema.find("minimum"), *above = schema.find("exclusiveMinimum"),
             *high = schema.find("maximum");
  std::string words;
  if (low) words = fmt::format(" from {:g}", low->number());
  if (above) words = fmt::format(" above {:g}", above->number());
  if (high) words += fmt::format("{} {:g}", low ? " to" : above ? ", at most" : " up to", high->number());
  return words;
}

std::string one_type_in_words(std::string_view type, const Json& schema, const Json& root) {
  if (type == "number") return "a number" + range_in_words(schema);
  if (type == "integer") return "an integer" + range_in_words(schema);
  if (type == "string") {
    const Json* pattern = schema.find("pattern");
    return pattern ? fmt::format("\"{}\"", fmt::join(words_of(*pattern), "\", \"")) : "a string";
  }
  if (type == "boolean") return "true or false";
  if (type == "null") return "null";
  if (type == "object") {
    const auto keys = keys_of(schema);
    return keys.empty() ? "an object" : "an object with the keys " + listed(keys);
  }
  std::string words = "an array";
  const Json *fewest = schema.find("minItems"), *most = schema.find("maxItems");
  if (fewest && most && fewest->number() == most->number()) words += fmt::format(" of {:g}", most->number());
  if (!fewest && most) words += fmt::format(" of at most {:g}", most->number());
  if (const Json* items = schema.find("items")) words += ", each " + accepted(*items, root);
  return words;
}

// The way from the root to a value, kept on the stack: written out only when something is wrong there.
struct Path {
  const Path* parent = nullptr;
  std::variant<std::string_view, std::size_t> step;

  std::string pointer() const {
    if (!parent) return "";
    return std::visit([&](const auto& s) { return pointer_to(parent->pointer(), s); }, step);
  }
};

class Checker {
 public:
  Checker(const Json& root, const std::string& file) : root_(root), file_(file) {}

  void check(const Json& value, const Json& part, const Path& at) const {
    const Json& schema = resolved(part, root_);
    check_type(value, schema, at);
    for (const auto& [keyword, says] : schema.members()) check_keyword(value, schema, keyword, says, at);
  }

 private:
  [[noreturn]] void refuse(const Path& at, std::string_view what, std::string_view accepts) const {
    const std::string pointer = at.pointer();
    throw InputError(file_ + ":" + (pointer.empty() ? "/" : pointer), what, accepts);
  }

  void check_type(const Json& value, const Json& schema, const Path& at) const {
    const auto types = types_of(schema);
    if (types.empty()) return;
    for (const std::string_view type : types)
      if (is_a(value, type)) return;
    refuse(at, "is " + in_words(value), accepted(schema, root_));
  }

  void check_keyword(const Json& value, const Json& schema, std::string_view keyword, const Json& says,
                     const Path& at) const {
    if (keyword == "properties") return check_members(value, schema, at);
    if (keyword == "required") return check_required(value, says, at);
    if (keyword == "items") return check_items(value, says, at);
    if (keyword == "enum") return check_enum(value, names_of(says), at);
    if (keyword == "pattern") return check_enum(value, words_of(says), at);
    if (keyword == "minItems" || keyword == "maxItems") return check_size(value, schema, keyword, says, at);
    if (keyword == "minimum" || keyword == "maximum" || keyword == "exclusiveMinimum")
      return check_range(value, schema, keyword, says, at);
    if (keyword == "const") {
      if (!value.is_text() || value.text() != says.text()) refuse(at, "is " + in_words(value), says.text());
      return;
    }
    if (keyword == "allOf") {
      for (const Json& part : says.items()) check(value, part, at);
      return;
    }
    if (keyword == "not") return check_not(value, says, at);
    if (keyword == "anyOf") return check_any(value, says, at);
    if (keyword == "oneOf") return check(value, alternative(value, says, at), at);
    if (keyword == "additionalProperties") {
      if (!schema.find("properties")) check_members(value, schema, at);
      return;
    }
    if (keyword != "type" && std::find(kSilent.begin(), kSilent.end(), keyword) == kSilent.end())
      throw std::logic_error(fmt::format("schema: unknown keyword {}", keyword));
  }

  void check_members(const Json& value, const Json& schema, const Path& at) const {
    if (!value.is_object()) return;
    const Json *properties = schema.find("properties"), *others = schema.find("additionalProperties");
    for (const auto& [key, member] : value.members()) {
      const Json* known = properties ? properties->find(key) : nullptr;
      if (!known && others && others->is_object()) known = others;
      if (!known) {
        const auto keys = keys_of(schema);
        refuse(Path{&at, std::string_view(key)}, unknown("key", key, keys),
               fmt::format("{}", fmt::join(keys, ", ")));
      }
      check(member, *known, Path{&at, std::string_view(key)});
    }
  }

  void check_required(const Json& value, const Json& keys, const Path& at) const {
    if (!value.is_object()) return;
    for (const std::string_view key : names_of(keys))
      if (!value.find(key)) refuse(at, fmt::format("the key '{}' is missing", key), {});
  }

  void check_items(const Json& value, const Json& item, const Path& at) const {
    if (!value.is_array()) return;
    for (std::size_t i = 0; i < value.items().size(); ++i) check(value.items()[i], item, Path{&at, i});
  }

  void check_enum(const Json& value, const std::vector<std::string_view>& known, const Path& at) const {
    if (!value.is_text()) return;
    if (std::find(known.begin(), known.end(), value.text()) == known.end())
      refuse(at, unknown("value", value.text(), known), listed(known));
  }

  void check_size(const Json& value, const Json& schema, std::string_view keyword, const Json& limit,
                  const Path& at) const {
    if (!value.is_array()) return;
    const double size = static_cast<double>(value.items().size());
    if (keyword == "minItems" ? size < limit.number() : size > limit.number())
      refuse(at, fmt::format("has {} elements", size), accepted(schema, root_));
  }

  void check_range(const Json& value, const Json& schema, std::string_view keyword, const Json& limit,
                   const Path& at) const {
    if (!value.is_number()) return;
    const double v = value.number(), end = limit.number();
    const bool inside = keyword == "minimum" ? v >= end : keyword == "maximum" ? v <= end : v > end;
    if (!inside) refuse(at, fmt::format("is {:g}", v), accepted(schema, root_));
  }

  static bool has_all(const Json& value, const Json& part) {
    const auto keys = names_of(*part.find("required"));
    return std::all_of(keys.begin(), keys.end(), [&](std::string_view key) { return value.find(key); });
  }

  void check_not(const Json& value, const Json& part, const Path& at) const {
    if (value.is_object() && has_all(value, part))
      refuse(
          at,
          fmt::format("'{}' cannot stand together", fmt::join(names_of(*part.find("required")), "' and '")),
          "one of them");
  }

  void check_any(const Json& value, const Json& parts, const Path& at) const {
    if (!value.is_object()) return;
    std::vector<std::string> ways;
    for (const Json& part : parts.items()) {
      if (has_all(value, part)) return;
      ways.push_back(fmt::format("'{}'", fmt::join(names_of(*part.find("required")), "' and '")));
    }
    refuse(at, fmt::format("{} is missing", fmt::join(ways, " or ")), {});
  }

  const Json& alternative(const Json& value, const Json& alternatives, const Path& at) const {
    std::vector<std::string_view> types;
    const Json* type = value.find("type");
    for (const Json& part : alternatives.items()) {
      const Json& schema = resolved(part, root_);
      types.push_back(schema.find("properties")->find("type")->find("const")->text());
      if (type && type->is_text() && type->text() == types.back()) return schema;
    }
    if (!value.is_object()) refuse(at, "is " + in_words(value), "an object with the key type");
    if (!type) refuse(at, "the key 'type' is missing", listed(types));
    if (!type->is_text()) refuse(Path{&at, std::string_view("type")}, "is " + in_words(*type), listed(types));
    refuse(Path{&at, std::string_view("type")}, unknown("value", type->text(), types), listed(types));
  }

  static std::string in_words(const Json& value) {
    if (value.is_null()) return "null";
    if (value.is_boolean()) return value.boolean() ? "true" : "false";
    if (value.is_number()) return fmt::format("{:g}", value.number());
    if (value.is_text()) return fmt::format("the string \"{}\"", value.text().substr(0, 60));
    return value.is_array() ? "an array" : "an object";
  }

  const Json& root_;
  const std::string& file_;
};

}  // namespace

std::string accepted(const Json& part, const Json& root) {
  const Json& schema = resolved(part, root);
  if (const Json* names = schema.find("enum")) return listed(names_of(*names));
  std::string words;
  for (const std::string_view type : types_of(schema))
    words += (words.empty() ? "" : ", or ") + one_type_in_words(type, schema, root);
  return words;
}

void check_schema(const Json& value, const Json& schema, const std::string& file) {
  Checker(schema, file).check(value, schema, Path{});
}

}  // namespace tessera
