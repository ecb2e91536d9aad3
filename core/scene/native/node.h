// SPDX-License-Identifier: Apache-2.0
// A value of a native scene file together with its place, read as what the schema has already made sure it
// is.
#pragma once

#include <filesystem>
#include <optional>
#include <string>

#include "core/scene/json.h"
#include "core/scene/scene.h"

namespace tessera {

inline constexpr float kPi = 3.14159265358979323846f;
inline float radians(float degrees) { return degrees * (kPi / 180.0f); }

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
  bool flag(std::string_view key, bool otherwise) const;
  std::string text(std::string_view key, std::string_view otherwise) const;
  Vec3 point(std::string_view key, const Vec3& otherwise) const;
  Color color(std::string_view key, const Color& otherwise) const;
  Vec3 direction(std::string_view key) const;  // unit; refuses length 0
  Matrix matrix(std::string_view key) const;
  std::filesystem::path path(std::string_view key) const;  // from the folder of the document
};

Vec3 as_vec3(const Json& array);

// The transform `node.transform`, or the identity.
Matrix transform_of(const Node& node);

}  // namespace tessera
