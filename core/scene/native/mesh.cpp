// SPDX-License-Identifier: Apache-2.0
#include <fmt/format.h>

#include "core/error.h"
#include "core/scene/native/parts.h"

namespace tessera {
namespace {

std::vector<Vec3> read_vectors(const Node& mesh, std::string_view key) {
  std::vector<Vec3> vectors;
  if (const Json* array = mesh.json->find(key))
    for (const Json& v : array->items()) vectors.push_back(as_vec3(v));
  return vectors;
}

std::vector<Vec2> read_uvs(const Node& mesh, std::string_view key) {
  std::vector<Vec2> uvs;
  if (const Json* array = mesh.json->find(key))
    for (const Json& v : array->items())
      uvs.emplace_back(static_cast<float>(v.items()[0].number()), static_cast<float>(v.items()[1].number()));
  return uvs;
}

std::vector<std::array<float, 4>> read_colors(const Node& mesh) {
  std::vector<std::array<float, 4>> colors;
  const Json* array = mesh.json->find("colors");
  if (!array) return colors;
  for (const Json& c : array->items()) {
    std::array<float, 4>& color = colors.emplace_back(std::array{1.0f, 1.0f, 1.0f, 1.0f});
    for (std::size_t i = 0; i < c.items().size(); ++i) color[i] = static_cast<float>(c.items()[i].number());
  }
  return colors;
}

// Polygons of `key` as fans of triangles around their first vertex.
void add_polygons(Mesh& result, const Node& mesh, std::string_view key) {
  const Json* array = mesh.json->find(key);
  if (!array) return;
  const auto vertex = [&](std::size_t polygon, std::size_t corner) {
    const double v = array->items()[polygon].items()[corner].number();
    if (v >= static_cast<double>(result.positions.size()))
      throw InputError(mesh.file + ":" + pointer_to(pointer_to(mesh.at(key).pointer, polygon), corner),
                       fmt::format("there is no vertex {}", v),
                       fmt::format("0 to {}", static_cast<std::int64_t>(result.positions.size()) - 1));
    return static_cast<std::uint32_t>(v);
  };
  for (std::size_t p = 0; p < array->items().size(); ++p)
    for (std::size_t c = 2; c < array->items()[p].items().size(); ++c)
      result.triangles.push_back({vertex(p, 0), vertex(p, c - 1), vertex(p, c)});
}

void check_parallel(const Node& mesh, std::string_view key, std::size_t count, std::size_t vertices) {
  if (mesh.has(key) && count != vertices)
    throw InputError(mesh.at(key).where(), fmt::format("has {} elements", count),
                     fmt::format("{}, one a vertex", vertices));
}

}  // namespace

Mesh read_mesh(const std::string& name, const Node& node) {
  Mesh mesh;
  mesh.name = name;
  mesh.positions = read_vectors(node, "positions");
  mesh.normals = read_vectors(node, "normals");
  mesh.uvs = read_uvs(node, "uvs");
  mesh.uvs2 = read_uvs(node, "uvs2");
  mesh.colors = read_colors(node);
  check_parallel(node, "normals", mesh.normals.size(), mesh.positions.size());
  check_parallel(node, "uvs", mesh.uvs.size(), mesh.positions.size());
  check_parallel(node, "uvs2", mesh.uvs2.size(), mesh.positions.size());
  check_parallel(node, "colors", mesh.colors.size(), mesh.positions.size());
  add_polygons(mesh, node, "triangles");
  add_polygons(mesh, node, "quads");
  return mesh;
}

}  // namespace tessera
