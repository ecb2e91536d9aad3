// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/values.h"

#include <array>
#include <cmath>

namespace tessera::gltf {
namespace {

template <std::size_t N>
std::optional<std::array<float, N>> floats(const tinygltf::Value& object, const std::string& key) {
  const tinygltf::Value* list = find(object, key);
  if (!list || !list->IsArray() || list->ArrayLen() < N) return {};
  std::array<float, N> result;
  for (std::size_t i = 0; i < N; ++i) {
    const tinygltf::Value& item = list->Get(static_cast<int>(i));
    if (!item.IsNumber()) return {};
    result[i] = static_cast<float>(item.GetNumberAsDouble());
  }
  return result;
}

}  // namespace

const tinygltf::Value* find(const tinygltf::ExtensionMap& extensions, const std::string& name) {
  const auto it = extensions.find(name);
  return it == extensions.end() || !it->second.IsObject() ? nullptr : &it->second;
}

const tinygltf::Value* find(const tinygltf::Value& object, const std::string& key) {
  return object.IsObject() && object.Has(key) ? &object.Get(key) : nullptr;
}

std::optional<double> number(const tinygltf::Value& object, const std::string& key) {
  const tinygltf::Value* value = find(object, key);
  if (!value || !value->IsNumber()) return {};
  return value->GetNumberAsDouble();
}

std::optional<int> integer(const tinygltf::Value& value) {
  if (!value.IsNumber()) return {};
  const double number = value.GetNumberAsDouble();
  if (!(std::abs(number) < 2147483647.0)) return {};
  return static_cast<int>(number);
}

std::optional<int> integer(const tinygltf::Value& object, const std::string& key) {
  const tinygltf::Value* value = find(object, key);
  return value ? integer(*value) : std::nullopt;
}

std::optional<std::string> text(const tinygltf::Value& object, const std::string& key) {
  const tinygltf::Value* value = find(object, key);
  if (!value || !value->IsString()) return {};
  return value->Get<std::string>();
}

float number_or(const tinygltf::Value& object, const std::string& key, float otherwise) {
  const auto value = number(object, key);
  return value ? static_cast<float>(*value) : otherwise;
}

Color color_or(const tinygltf::Value& object, const std::string& key, const Color& otherwise) {
  const auto v = floats<3>(object, key);
  return v ? Color((*v)[0], (*v)[1], (*v)[2]) : otherwise;
}

Vec2 vec2_or(const tinygltf::Value& object, const std::string& key, const Vec2& otherwise) {
  const auto v = floats<2>(object, key);
  return v ? Vec2((*v)[0], (*v)[1]) : otherwise;
}

}  // namespace tessera::gltf
