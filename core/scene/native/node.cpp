// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/node.h"

#include <cmath>

#include "core/error.h"

namespace tessera {
namespace {

float as_float(const Json& number) { return static_cast<float>(number.number()); }

Matrix as_matrix(const Json& array) {
  Matrix m;
  for (int i = 0; i < 16; ++i) m[i / 4][i % 4] = as_float(array.items()[static_cast<std::size_t>(i)]);
  return m;
}

}  // namespace

Vec3 as_vec3(const Json& array) {
  const auto& v = array.items();
  return {as_float(v[0]), as_float(v[1]), as_float(v[2])};
}

Vec3 as_vec3_or_number(const Json& value) {
  return value.is_number() ? Vec3(as_float(value)) : as_vec3(value);
}

std::optional<Node> Node::find(std::string_view key) const {
  const Json* member = json->find(key);
  if (!member) return {};
  return Node{member, file, pointer_to(pointer, key)};
}

std::vector<Node> Node::items() const {
  std::vector<Node> nodes;
  for (std::size_t i = 0; i < json->items().size(); ++i)
    nodes.push_back({&json->items()[i], file, pointer_to(pointer, i)});
  return nodes;
}

std::vector<std::pair<std::string, Node>> Node::members() const {
  std::vector<std::pair<std::string, Node>> nodes;
  for (const auto& [key, value] : json->members())
    nodes.emplace_back(key, Node{&value, file, pointer_to(pointer, key)});
  return nodes;
}

float Node::number(std::string_view key, float otherwise) const {
  const Json* member = json->find(key);
  return member ? as_float(*member) : otherwise;
}

bool Node::flag(std::string_view key, bool otherwise) const {
  const Json* member = json->find(key);
  return member ? member->boolean() : otherwise;
}

std::string Node::text(std::string_view key, std::string_view otherwise) const {
  const Json* member = json->find(key);
  return member ? member->text() : std::string(otherwise);
}

Vec3 Node::point(std::string_view key, const Vec3& otherwise) const {
  const Json* member = json->find(key);
  return member ? as_vec3(*member) : otherwise;
}

Color Node::color(std::string_view key, const Color& otherwise) const {
  const Json* member = json->find(key);
  return member ? Color(as_vec3_or_number(*member)) : otherwise;
}

float Node::angle(std::string_view key, double degrees) const {
  const Json* member = json->find(key);
  return radians(member ? member->number() : degrees);
}

int Node::integer(std::string_view key, int otherwise) const {
  const Json* member = json->find(key);
  return member ? static_cast<int>(member->number()) : otherwise;
}

Vec3 Node::direction(std::string_view key) const {
  const Vec3 d = as_vec3(*json->find(key));
  const double length = Imath::V3d(d).length();
  if (length == 0) throw InputError(at(key).where(), "has no length", "a direction");
  return std::abs(length - 1) < 1e-6 ? d : Vec3(Imath::V3d(d) / length);
}

Matrix Node::matrix(std::string_view key) const { return as_matrix(*json->find(key)); }

std::filesystem::path Node::path(std::string_view key) const { return folder() / text(key, {}); }

}  // namespace tessera
