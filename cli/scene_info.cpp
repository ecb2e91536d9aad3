// SPDX-License-Identifier: Apache-2.0
#include "cli/scene_info.h"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "core/scene/info.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

using nlohmann::ordered_json;

std::string bytes_in_words(std::uint64_t bytes) {
  const auto b = static_cast<double>(bytes);
  if (bytes >= 1u << 30) return fmt::format("{:.2f} GiB", b / (1u << 30));
  if (bytes >= 1u << 20) return fmt::format("{:.1f} MiB", b / (1u << 20));
  return fmt::format("{:.1f} KiB", b / (1u << 10));
}

std::string counts_in_words(const Counts& counts) {
  std::string words;
  for (const auto& [name, count] : counts)
    if (count > 0) words += fmt::format("{}{} {}", words.empty() ? "" : ", ", count, name);
  return words.empty() ? "none" : words;
}

std::string names_in_words(const std::vector<std::string>& names) {
  std::string words;
  for (const std::string& name : names)
    words += fmt::format("{}{}", words.empty() ? "" : ", ", name.empty() ? "(no name)" : name);
  return words.empty() ? "none" : words;
}

std::string point(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

ordered_json json(const Counts& counts) {
  ordered_json j = ordered_json::object();
  for (const auto& [name, count] : counts) j[name] = count;
  return j;
}

}  // namespace

std::string info_table(const Scene& scene) {
  const SceneInfo info = info_of(scene);
  std::string text;
  const auto row = [&](std::string_view name, const std::string& value) {
    text += fmt::format("{:<13} {}\n", name, value);
  };
  row("name", scene.name);
  row("triangles", fmt::format("{}, {} with instances", info.triangles, info.instanced_triangles));
  row("vertices", fmt::format("{}", info.vertices));
  row("things", counts_in_words(info.things));
  row("materials", counts_in_words(info.materials));
  row("lights", counts_in_words(info.lights));
  row("light groups", names_in_words(info.light_groups));
  row("cameras", names_in_words(info.cameras));
  row("variants", names_in_words(info.variants));
  row("bounds", info.bounds.isEmpty() ? "none" : point(info.bounds.min) + " to " + point(info.bounds.max));
  for (const auto& [name, bytes] : info.memory)
    row("memory", fmt::format("{} {}", bytes_in_words(bytes), name));
  for (const auto& p : info.pictures)
    row("picture",
        fmt::format("{} x {} x {}, {}: {}", p.width, p.height, p.channels, bytes_in_words(p.bytes), p.name));
  row("hash", content_hash(scene));
  return text;
}

std::string info_json(const Scene& scene) {
  const SceneInfo info = info_of(scene);
  ordered_json j;
  j["name"] = scene.name;
  j["hash"] = content_hash(scene);
  j["triangles"] = {{"unique", info.triangles}, {"instanced", info.instanced_triangles}};
  j["vertices"] = info.vertices;
  j["things"] = json(info.things);
  j["materials"] = json(info.materials);
  j["lights"] = json(info.lights);
  j["light_groups"] = info.light_groups;
  j["cameras"] = info.cameras;
  j["variants"] = info.variants;
  j["bounds"] = nullptr;
  if (const auto& b = info.bounds; !b.isEmpty())
    j["bounds"] = {{b.min.x, b.min.y, b.min.z}, {b.max.x, b.max.y, b.max.z}};
  j["memory"] = json(info.memory);
  j["pictures"] = ordered_json::array();
  for (const auto& p : info.pictures)
    j["pictures"].push_back({{"file", p.name},
                             {"width", p.width},
                             {"height", p.height},
                             {"channels", p.channels},
                             {"bytes", p.bytes}});
  j["warnings"] = info.warnings;
  return j.dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + '\n';
}

}  // namespace tessera
