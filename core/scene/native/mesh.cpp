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

std::vector<Vec2> read_uvs(const Node& mesh) {
  std::vector<Vec2> uvs;
  if (const Json* array = mesh.json->find("uvs"))
    for (const Json& v : array->items())
      uvs.emplace_back(static_cast<float>(v.items()[0].number()), static_cast<float>(v.items()[1].number()));
  return uvs;
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
  mesh.uvs = read_uvs(node);
  check_parallel(node, "normals", mesh.normals.size(), mesh.positions.size());
  check_parallel(node, "uvs", mesh.uvs.size(), mesh.positions.size());
  add_polygons(mesh, node, "triangles");
  add_polygons(mesh, node, "quads");
  return mesh;
}

}  // namespace tessera
