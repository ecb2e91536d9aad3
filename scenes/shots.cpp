// SPDX-License-Identifier: Apache-2.0
#include "scenes/shots.h"

#include "scenes/courtyard.h"
#include "scenes/native.h"
#include "scenes/paint.h"

namespace tessera::scenes {
namespace {

constexpr double kFramesPerSecond = 24;
constexpr double kEnd = kShotFrames / kFramesPerSecond;

// A pinhole: surfaces seen through a lens have no single place in the frame before.
ordered_json courtyard(const char* name) {
  return {{"name", name},
          {"frames_per_second", kFramesPerSecond},
          {"import", {{{"file", "courtyard.json"}, {"cameras", false}}}},
          {"camera", {{"horizontal_fov", 66}}}};
}

ordered_json look(const Vec& from, const Vec& to) { return {{"from", json(from)}, {"to", json(to)}}; }

ordered_json still() {
  ordered_json scene = courtyard("courtyard, still");
  scene["camera"]["look_at"] = look({2.7, 1.65, 7.5}, {0.45, 1.5, -2.5});
  return scene;
}

ordered_json flight() {
  struct Stop {
    Vec from, to;
  };
  constexpr int kStops = 5;
  const Stop stops[kStops] = {{{2.7, 1.65, 7.5}, {0.45, 1.5, -2.5}},
                              {{2.75, 1.66, 6.6}, {0.1, 1.5, -2.8}},
                              {{2.7, 1.7, 5.7}, {-0.4, 1.45, -3.0}},
                              {{2.5, 1.75, 4.9}, {-1.0, 1.4, -3.0}},
                              {{2.2, 1.8, 4.2}, {-1.7, 1.35, -2.8}}};
  ordered_json scene = courtyard("courtyard, a walk");
  for (int i = 0; i < kStops; ++i)
    scene["camera"]["keys"].push_back(
        {{"time", kEnd * i / (kStops - 1)}, {"look_at", look(stops[i].from, stops[i].to)}});
  return scene;
}

// Roughness 0.32 is an alpha of 0.1, that of the glossy scene of Koskela et al. 2019, section 7.2.
ordered_json glossy_flight() {
  ordered_json scene = flight();
  scene["name"] = "courtyard, a walk, all glossy";
  for (const char* name : {"stucco", "stone", "wood", "earth", "terracotta", "bark", "orange leaf",
                           "agave leaf", "cypress leaf", "orange"})
    scene["materials"][name] = {{"type", "metallic_roughness"}, {"roughness", 0.32}};
  return scene;
}

ordered_json light() {
  ordered_json scene = box_room("box, the lamp wanders");
  scene["camera"] = {{"look_at", look({0, 0.85, 2.75}, {0, 0.75, 0})}, {"horizontal_fov", 58}};
  scene["frames_per_second"] = kFramesPerSecond;
  scene["materials"]["blue"] = color({0.15, 0.25, 0.6});
  add_box(scene, "tall", "white", {-0.65, 0, -0.6}, {-0.05, 1.2, -0.05});
  add_sphere(scene, {0.45, 0.38, 0.25}, 0.38, "blue");
  scene["materials"]["lamp"] = {{"color", 0}, {"emission", {34, 26, 16}}, {"double_sided", false}};
  add_sheet(scene, "lamp", "lamp", {-0.25, 1.95, -0.25}, {0.5, 0, 0}, {0, 0, 0.5});
  scene["meshes"]["lamp"]["object"] = "lamp";
  scene["objects"]["lamp"]["keys"] = {{{"time", 0}, {"translate", {-0.6, 0, 0.4}}},
                                      {{"time", kEnd / 2}, {"translate", {0.5, 0, 0.5}}},
                                      {{"time", kEnd}, {"translate", {0.6, 0, -0.5}}}};
  return scene;
}

ordered_json object() {
  ordered_json scene = terrace("terrace, a crate in motion");
  scene["frames_per_second"] = kFramesPerSecond;
  scene["materials"]["crate"] = color({0.5, 0.3, 0.12});
  add_box(scene, "crate", "crate", {-0.4, 0, -0.4}, {0.4, 0.8, 0.4});
  scene["meshes"]["crate"]["object"] = "crate";
  constexpr int kKeys = 5;  // a sixth of a turn between two of them
  for (int i = 0; i < kKeys; ++i)
    scene["objects"]["crate"]["keys"].push_back({{"time", kEnd * i / (kKeys - 1)},
                                                 {"rotate", {0, 60 * i, 0}},
                                                 {"translate", {-2.4 + 0.7 * i, 0, 1.6 - 0.1 * i}}});
  return scene;
}

}  // namespace

void write_shots(const std::filesystem::path& folder) {
  write_courtyard(folder);  // and the pictures of the terrace with it
  ordered_json (*const made[])() = {flight, glossy_flight, still, light, object};
  static_assert(std::size(made) == std::size(kShots));
  for (std::size_t i = 0; i < std::size(kShots); ++i) write(made[i](), folder, kShots[i]);
}

}  // namespace tessera::scenes
