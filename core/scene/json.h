// SPDX-License-Identifier: Apache-2.0
// A JSON document as a value. Parsing is strict (RFC 8259): no comments, no NaN, no key twice in an object.
#pragma once

#include <string>
#include <string_view>
#include <variant>
#include <vector>

namespace tessera {

struct Json {
  using Array = std::vector<Json>;
  struct Member;
  using Object = std::vector<Member>;  // in the file's order
  std::variant<std::nullptr_t, bool, double, std::string, Array, Object> value;

  const Json* find(std::string_view key) const;  // nullptr if this is no object or has no such member

  // The value as what it is known to be: wrong guesses throw std::bad_variant_access.
  bool boolean() const { return std::get<bool>(value); }
  double number() const { return std::get<double>(value); }
  const std::string& text() const { return std::get<std::string>(value); }
  const Array& items() const { return std::get<Array>(value); }
  const Object& members() const { return std::get<Object>(value); }

  bool is_null() const { return std::holds_alternative<std::nullptr_t>(value); }
  bool is_boolean() const { return std::holds_alternative<bool>(value); }
  bool is_number() const { return std::holds_alternative<double>(value); }
  bool is_text() const { return std::holds_alternative<std::string>(value); }
  bool is_array() const { return std::holds_alternative<Array>(value); }
  bool is_object() const { return std::holds_alternative<Object>(value); }
};

struct Json::Member {
  std::string first;  // the key
  Json second;
};

// Throws InputError at file:line:column. Nesting deeper than 64 is refused.
Json parse_json(std::string_view text, const std::string& file);

// `pointer` with one more step, escaped as RFC 6901 says.
std::string pointer_to(const std::string& pointer, std::string_view key);
std::string pointer_to(const std::string& pointer, std::size_t index);

}  // namespace tessera
