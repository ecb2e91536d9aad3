// SPDX-License-Identifier: Apache-2.0
// A value of a native scene file together with its place, read as what the schema has already made sure it
// is.
#pragma once

#include <filesystem>
#include <optional>
#include <stdexcept>
#include <string>

#include "core/scene/json.h"
#include "core/scene/scene.h"

namespace tessera {

inline constexpr double kPi = 3.14159265358979323846;
// In doubles, so that every float is the radians of some number of degrees.
inline float radians(double degrees) { return static_cast<float>(degrees * (kPi / 180)); }

struct Node {
  const Json* json;  // borrowed from the document
  std::string file, pointer;

  std::string where() const { return file + ":" + (pointer.empty() ? "/" : pointer); }
  std::filesystem::path folder() const { return std::filesystem::path(file).parent_path(); }

  bool has(std::string_view key) const { return json->find(key) != nullptr; }
  std::optional<Node> find(std::string_view key) const;
  Node at(std::string_view key) const { return find(key).value(); }
  std::vector<Node> items() const;                            // of an array
  std::vector<std::pair<std::string, Node>> members() const;  // of an object

  // The member `key`, or `otherwise` if there is none.
  float number(std::string_view key, float otherwise) const;
  float angle(std::string_view key, double degrees) const;  // radians
  int integer(std::string_view key, int otherwise) const;
  bool flag(std::string_view key, bool otherwise) const;
  std::string text(std::string_view key, std::string_view otherwise) const;
  Vec3 point(std::string_view key, const Vec3& otherwise) const;
  Color color(std::string_view key, const Color& otherwise) const;
  Vec3 direction(std::string_view key) const;  // unit; refuses length 0. A unit vector stays as it is
  Matrix matrix(std::string_view key) const;
  std::filesystem::path path(std::string_view key) const;  // from the folder of the document
};

Vec3 as_vec3(const Json& array);
Vec3 as_vec3_or_number(const Json&);  // one number: for all three

// What `translate`, `rotate` and `scale`, or `matrix`, of the node say.
Matrix read_transform(const Node& node);

// The transform `node.transform`, or the identity.
Matrix transform_of(const Node& node);

// Rows: the axes and the position of a camera that looks along its own -Z.
Matrix looking(const Node& look_at);

// First a, then b; to the bit the other one if one of them does nothing.
Matrix then(const Matrix& a, const Matrix& b);

// The value of a name that the schema lets through.
template <class Table>
auto named(const Table& table, std::string_view name) {
  for (const auto& [known, value] : table)
    if (known == name) return value;
  throw std::logic_error("the schema let through a name the reader does not know: " + std::string(name));
}

}  // namespace tessera
