// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include <cstdlib>
#include <set>

#include "core/scene/native/node.h"
#include "core/scene/native/write_parts.h"

namespace tessera {
namespace {

template <class Things>
std::vector<std::string> different_names(const Things& things, std::string_view kind) {
  std::vector<std::string> names;
  std::set<std::string> taken;
  for (const auto& thing : things) {
    const std::string wanted = thing.name.empty() ? fmt::format("{} {}", kind, names.size() + 1) : thing.name;
    std::string name = wanted;
    for (int n = 2; !taken.insert(name).second; ++n) name = fmt::format("{} {}", wanted, n);
    names.push_back(name);
  }
  return names;
}

}  // namespace

Names names_of(const Scene& scene) {
  return {different_names(scene.materials, "material"), different_names(scene.meshes, "mesh"),
          different_names(scene.objects, "object")};
}

void Members::add_number(std::string key, float value, float standard) {
  if (value != standard) add(std::move(key), number(value));
}

void Members::add_angle(std::string key, float value, float standard) {
  if (value != standard) add(std::move(key), degrees(value));
}

void Members::add_color(std::string key, const Color& value, const Color& standard) {
  if (value == standard) return;
  const bool grey = value.x == value.y && value.x == value.z;
  add(std::move(key), grey ? number(value.x) : array_of(&value.x, 3));
}

Json number(double v) { return {v}; }
Json text(std::string v) { return {std::move(v)}; }

Json array_of(const float* values, std::size_t count) {
  Json::Array array;
  for (std::size_t i = 0; i < count; ++i) array.push_back(number(values[i]));
  return {std::move(array)};
}

Json point(const Vec3& v) { return array_of(&v.x, 3); }

Json degrees(float value) {
  const double exact = value * (180 / kPi);
  for (const int digits : {4, 6, 8}) {
    const double round = std::strtod(fmt::format("{:.{}g}", exact, digits).c_str(), nullptr);
    if (radians(round) == value) return number(round);
  }
  return number(exact);
}

Json matrix(const Matrix& m) { return array_of(&m[0][0], 16); }

std::string relative_to(const std::filesystem::path& folder, const std::filesystem::path& file) {
  const auto whole = [](const std::filesystem::path& p) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(p));
  };
  return whole(file).lexically_relative(whole(folder)).generic_string();
}

}  // namespace tessera
