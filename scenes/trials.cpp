// SPDX-License-Identifier: Apache-2.0
#include "scenes/trials.h"

#include <string>

#include "scenes/native.h"
#include "scenes/paint.h"

namespace tessera::scenes {
namespace {

ordered_json lit_room(const char* name) {
  ordered_json scene = box_room(name);
  add_lamp(scene, {-0.35, 1.99, -0.35}, {0.7, 0, 0}, {0, 0, 0.7}, {17, 13, 8});
  return scene;
}

ordered_json box_diffuse() {
  ordered_json scene = lit_room("box, diffuse");
  scene["materials"]["blue"] = color({0.15, 0.25, 0.6});
  add_box(scene, "tall", "white", {-0.65, 0, -0.6}, {-0.05, 1.2, -0.05});
  add_sphere(scene, {0.45, 0.38, 0.25}, 0.38, "blue");
  return scene;
}

ordered_json box_glossy() {
  ordered_json scene = lit_room("box, glossy");
  scene["materials"]["gold"] = metal("gold", 0.3);
  scene["materials"]["lacquer"] = {{"type", "plastic"}, {"color", {0.1, 0.2, 0.6}}, {"roughness", 0.15}};
  scene["materials"]["polished"] = {{"type", "plastic"}, {"color", {0.5, 0.45, 0.4}}, {"roughness", 0.25}};
  scene["meshes"]["floor"]["material"] = "polished";
  add_sphere(scene, {-0.45, 0.45, -0.3}, 0.45, "gold");
  add_sphere(scene, {0.5, 0.35, 0.25}, 0.35, "lacquer");
  return scene;
}

ordered_json box_glass() {
  ordered_json scene = lit_room("box, glass and mirror");
  scene["materials"]["glass"] = {{"type", "glass"}};
  scene["materials"]["mirror"] = {{"type", "mirror"}, {"color", 0.95}};
  add_sphere(scene, {-0.45, 0.45, -0.3}, 0.45, "mirror");
  add_sphere(scene, {0.45, 0.4, 0.3}, 0.4, "glass");
  return scene;
}

ordered_json sphere() {
  ordered_json scene = empty_scene("sphere under a sky", camera({0, 1.3, 3.6}, {0, 0.75, 0}, 38));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 120}};
  scene["materials"] = {{"clay", color({0.7, 0.62, 0.5})}, {"ground", color({0.45, 0.45, 0.45})}};
  add_sheet(scene, "ground", "ground", {-8, 0, 8}, {16, 0, 0}, {0, 0, -16});
  add_sphere(scene, {0, 0.8, 0}, 0.8, "clay");
  return scene;
}

ordered_json shadow() {
  ordered_json scene = empty_scene("soft shadows", camera({0, 2.4, 6}, {0, 0.8, 0}, 36));
  scene["materials"] = {{"wall", color({0.7, 0.7, 0.7})}, {"blocks", color({0.65, 0.45, 0.3})}};
  add_sheet(scene, "floor", "wall", {-4, 0, 4}, {8, 0, 0}, {0, 0, -8});
  add_sheet(scene, "back", "wall", {-4, 0, -2.5}, {8, 0, 0}, {0, 4, 0});
  for (int i = 0; i < 4; ++i)
    add_box(scene, "block" + std::to_string(i), "blocks", {-1.9 + 1.1 * i, 0, -0.6 - 0.3 * (i % 2)},
            {-1.5 + 1.1 * i, 0.5 + 0.35 * i, -0.2 - 0.3 * (i % 2)});
  add_lamp(scene, {-3.4, 3.4, 0.5}, {1.6, 1.4, 0}, {0, 0, 2}, {9, 9, 9});
  return scene;
}

ordered_json outside() { return terrace("terrace"); }

ordered_json glossy() {
  ordered_json scene = empty_scene("glossy", camera({0, 1.5, 5.6}, {0, 0.5, 0}, 38));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 200}};
  add_tiles(scene, 0.12);
  add_sheet(scene, "floor", "tiles", {-5, 0, 4}, {10, 0, 0}, {0, 0, -10}, 12);
  constexpr double kRoughness[] = {0.05, 0.15, 0.3, 0.5};
  constexpr const char* kMetals[] = {"silver", "gold", "copper", "iron"};
  for (int i = 0; i < 4; ++i) {
    const std::string name = std::string(kMetals[i]);
    scene["materials"][name] = metal(kMetals[i], kRoughness[i]);
    add_sphere(scene, {-1.5 + i, 0.45, 0}, 0.45, name);
  }
  add_lamp(scene, {-1.2, 2.6, 1.2}, {0.8, 0, 0}, {0, 0, 0.8}, {14, 13, 11});
  return scene;
}

ordered_json focus() {
  ordered_json scene = empty_scene("depth of field", camera({0.6, 1.1, 3.6}, {0, 0.45, 0}, 34));
  scene["camera"]["lens_radius"] = 0.12;
  scene["camera"]["focus_distance"] = 3.6;
  add_tiles(scene, 0.4);
  scene["materials"]["clay"] = color({0.7, 0.35, 0.2});
  scene["materials"]["brass"] = metal("brass", 0.2);
  scene["environment"] = {{"radiance", {0.35, 0.4, 0.5}}};
  add_sheet(scene, "floor", "tiles", {-6, 0, 3}, {12, 0, 0}, {0, 0, -12}, 18);
  for (int i = -2; i <= 2; ++i)
    add_sphere(scene, {0.55 * i, 0.35, -1.1 * i}, 0.35, i % 2 == 0 ? "clay" : "brass");
  add_lamp(scene, {-0.8, 3.0, -0.8}, {1.6, 0, 0}, {0, 0, 1.6}, {8, 7.5, 7});
  return scene;
}

}  // namespace

void write_trials(const std::filesystem::path& folder) {
  std::filesystem::create_directories(folder);
  paint_tiles(folder);
  paint_sky(folder, 0.6f);
  ordered_json (*const made[])() = {box_diffuse, box_glossy, box_glass, sphere,
                                    outside,     shadow,     glossy,    focus};
  static_assert(std::size(made) == std::size(kTrials));
  for (std::size_t i = 0; i < std::size(kTrials); ++i) write(made[i](), folder, kTrials[i]);
}

}  // namespace tessera::scenes
