// SPDX-License-Identifier: Apache-2.0
#include "core/scene/limits.h"

#include <fmt/format.h>

#include <array>

#include "core/error.h"
#include "core/nearest.h"

namespace tessera {
namespace {

struct Limit {
  std::string_view name;
  std::uint64_t ImportLimits::*field;
};
constexpr std::array kLimits{Limit{"file_bytes", &ImportLimits::file_bytes},
                             Limit{"vertices", &ImportLimits::vertices},
                             Limit{"triangles", &ImportLimits::triangles},
                             Limit{"instances", &ImportLimits::instances},
                             Limit{"picture_pixels", &ImportLimits::picture_pixels},
                             Limit{"node_depth", &ImportLimits::node_depth},
                             Limit{"depth", &ImportLimits::depth}};

void require(std::uint64_t count, std::uint64_t most, std::string_view limit, std::string_view where) {
  if (count > most)
    throw InputError(where, fmt::format("the scene has {} {}", count, limit),
                     fmt::format("at most {} (limit {})", most, limit));
}

}  // namespace

void set_limit(ImportLimits& limits, std::string_view name, std::uint64_t value) {
  for (const Limit& l : kLimits)
    if (l.name == name) {
      limits.*l.field = value;
      return;
    }
  const auto names = limit_names();
  throw Error(ExitCode::bad_usage,
              fmt::format("{}; accepted: {}", unknown("limit", name, names), listed(names)));
}

std::vector<std::string_view> limit_names() {
  std::vector<std::string_view> names;
  for (const Limit& l : kLimits) names.push_back(l.name);
  return names;
}

void Tally::count(const Scene& scene, std::string_view where) {
  for (; meshes_ < scene.meshes.size(); ++meshes_) {
    vertices_ += scene.meshes[meshes_].positions.size();
    triangles_ += scene.meshes[meshes_].triangles.size();
  }
  for (; pictures_ < scene.pictures.size(); ++pictures_)
    pixels_ += static_cast<std::uint64_t>(scene.pictures[pictures_].width) *
               static_cast<std::uint64_t>(scene.pictures[pictures_].height);
  require(vertices_, limits_.vertices, "vertices", where);
  require(triangles_, limits_.triangles, "triangles", where);
  require(pixels_, limits_.picture_pixels, "picture_pixels", where);
  require(scene.instances.size() + scene.spheres.size() + scene.quads.size() + scene.disks.size(),
          limits_.instances, "instances", where);
}

}  // namespace tessera
