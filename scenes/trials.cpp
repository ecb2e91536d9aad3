// SPDX-License-Identifier: Apache-2.0
#include "scenes/trials.h"

#include <Imath/ImathVec.h>

#include <fstream>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>

#include "scenes/paint.h"

namespace tessera::scenes {
namespace {

using nlohmann::ordered_json;
using Vec = Imath::V3d;

ordered_json json(const Vec& v) { return {v.x, v.y, v.z}; }

ordered_json camera(const Vec& from, const Vec& to, double fov) {
  return {{"look_at", {{"from", json(from)}, {"to", json(to)}}}, {"vertical_fov", fov}};
}

ordered_json color(const Vec& c) { return {{"color", json(c)}}; }

ordered_json metal(const char* name, double roughness) {
  return {{"type", "metal"}, {"metal", name}, {"roughness", roughness}};
}

// A rectangle; with `repeats`, its texture coordinates go up to that.
void add_sheet(ordered_json& scene, const std::string& name, const char* material, const Vec& corner,
               const Vec& u, const Vec& v, double repeats = 0) {
  ordered_json& mesh = scene["meshes"][name];
  mesh = {{"material", material},
          {"positions", {json(corner), json(corner + u), json(corner + u + v), json(corner + v)}},
          {"quads", {{0, 1, 2, 3}}}};
  if (repeats > 0) mesh["uvs"] = {{0, 0}, {repeats, 0}, {repeats, repeats}, {0, repeats}};
}

void add_box(ordered_json& scene, const std::string& name, const char* material, const Vec& low,
             const Vec& high) {
  ordered_json positions,
      quads = {{0, 2, 3, 1}, {4, 5, 7, 6}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 4, 6, 2}, {1, 3, 7, 5}};
  for (int corner = 0; corner < 8; ++corner)
    positions.push_back(
        json({corner & 1 ? high.x : low.x, corner & 2 ? high.y : low.y, corner & 4 ? high.z : low.z}));
  scene["meshes"][name] = {{"material", material}, {"positions", positions}, {"quads", quads}};
}

void add_sphere(ordered_json& scene, const Vec& center, double radius, const std::string& material) {
  scene["spheres"].push_back({{"center", json(center)}, {"radius", radius}, {"material", material}});
}

// A lamp that shines down, or along u x v.
void add_lamp(ordered_json& scene, const Vec& corner, const Vec& u, const Vec& v, const Vec& radiance) {
  const std::string name = "lamp" + std::to_string(scene["quads"].size());
  scene["materials"][name] = {{"color", 0}, {"emission", json(radiance)}, {"double_sided", false}};
  scene["quads"].push_back(
      {{"corner", json(corner)}, {"edge_u", json(u)}, {"edge_v", json(v)}, {"material", name}});
}

ordered_json empty_scene(const char* name, ordered_json view) {
  return {{"name", name},
          {"camera", std::move(view)},
          {"environment", {{"radiance", 0}}},
          {"materials", ordered_json::object()},
          {"meshes", ordered_json::object()},
          {"spheres", ordered_json::array()},
          {"quads", ordered_json::array()}};
}

// Two metres each way, open towards the camera.
ordered_json box_room(const char* name) {
  ordered_json scene = empty_scene(name, camera({0, 1, 4.6}, {0, 1, 0}, 32));
  scene["materials"] = {{"white", color({0.74, 0.73, 0.71})},
                        {"red", color({0.55, 0.06, 0.05})},
                        {"green", color({0.10, 0.42, 0.09})}};
  add_sheet(scene, "floor", "white", {-1, 0, 1}, {2, 0, 0}, {0, 0, -2});
  add_sheet(scene, "ceiling", "white", {-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  add_sheet(scene, "back", "white", {-1, 0, -1}, {2, 0, 0}, {0, 2, 0});
  add_sheet(scene, "left", "red", {-1, 0, 1}, {0, 0, -2}, {0, 2, 0});
  add_sheet(scene, "right", "green", {1, 0, -1}, {0, 0, 2}, {0, 2, 0});
  add_lamp(scene, {-0.35, 1.99, -0.35}, {0.7, 0, 0}, {0, 0, 0.7}, {17, 13, 8});
  return scene;
}

ordered_json box_diffuse() {
  ordered_json scene = box_room("box, diffuse");
  scene["materials"]["blue"] = color({0.15, 0.25, 0.6});
  add_box(scene, "tall", "white", {-0.65, 0, -0.6}, {-0.05, 1.2, -0.05});
  add_sphere(scene, {0.45, 0.38, 0.25}, 0.38, "blue");
  return scene;
}

ordered_json box_glossy() {
  ordered_json scene = box_room("box, glossy");
  scene["materials"]["gold"] = metal("gold", 0.3);
  scene["materials"]["lacquer"] = {{"type", "plastic"}, {"color", {0.1, 0.2, 0.6}}, {"roughness", 0.15}};
  scene["materials"]["polished"] = {{"type", "plastic"}, {"color", {0.5, 0.45, 0.4}}, {"roughness", 0.25}};
  scene["meshes"]["floor"]["material"] = "polished";
  add_sphere(scene, {-0.45, 0.45, -0.3}, 0.45, "gold");
  add_sphere(scene, {0.5, 0.35, 0.25}, 0.35, "lacquer");
  return scene;
}

ordered_json box_glass() {
  ordered_json scene = box_room("box, glass and mirror");
  scene["materials"]["glass"] = {{"type", "glass"}};
  scene["materials"]["mirror"] = {{"type", "mirror"}, {"color", 0.95}};
  add_sphere(scene, {-0.45, 0.45, -0.3}, 0.45, "mirror");
  add_sphere(scene, {0.45, 0.4, 0.3}, 0.4, "glass");
  return scene;
}

void tile(ordered_json& scene, double roughness) {
  scene["materials"]["tiles"] = {
      {"type", "plastic"}, {"color_texture", "tiles.png"}, {"roughness", roughness}};
}

ordered_json sphere() {
  ordered_json scene = empty_scene("sphere under a sky", camera({0, 1.3, 3.6}, {0, 0.75, 0}, 38));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 120}};
  scene["materials"] = {{"clay", color({0.7, 0.62, 0.5})}, {"ground", color({0.45, 0.45, 0.45})}};
  add_sheet(scene, "ground", "ground", {-8, 0, 8}, {16, 0, 0}, {0, 0, -16});
  add_sphere(scene, {0, 0.8, 0}, 0.8, "clay");
  return scene;
}

ordered_json outside() {
  ordered_json scene = empty_scene("terrace", camera({-2.2, 1.6, 5.5}, {0.2, 0.9, 0}, 42));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 40}};
  scene["lights"] = {{{"type", "directional"},
                      {"direction", {-0.6, -0.7, -0.5}},
                      {"irradiance", {3.6, 3.1, 2.3}},
                      {"angular_diameter", 0.53}}};
  scene["materials"] = {{"plaster", color({0.75, 0.7, 0.62})},
                        {"leaf", color({0.12, 0.3, 0.07})},
                        {"steel", metal("chromium", 0.12)}};
  tile(scene, 0.3);
  add_sheet(scene, "floor", "tiles", {-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, 16);
  add_box(scene, "wall", "plaster", {-3, 0, -2.2}, {1.2, 1.9, -1.9});
  for (int i = 0; i < 5; ++i)
    add_box(scene, "post" + std::to_string(i), "plaster", {1.5 + 0.45 * i, 0, -2.2},
            {1.62 + 0.45 * i, 1.7, -2.08});
  add_sphere(scene, {-1.2, 0.6, -0.6}, 0.6, "leaf");
  add_sphere(scene, {0.7, 0.45, 0.6}, 0.45, "steel");
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

ordered_json glossy() {
  ordered_json scene = empty_scene("glossy", camera({0, 1.5, 5.6}, {0, 0.5, 0}, 38));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 200}};
  tile(scene, 0.12);
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
  tile(scene, 0.4);
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
  for (std::size_t i = 0; i < std::size(kTrials); ++i) {
    std::ofstream file(folder / (std::string(kTrials[i]) + ".json"));
    file << made[i]().dump(1) << '\n';
    if (!file.flush()) throw std::runtime_error("cannot write " + (folder / kTrials[i]).string());
  }
}

}  // namespace tessera::scenes
