// SPDX-License-Identifier: Apache-2.0
#include "scenes/native.h"

#include <fstream>
#include <stdexcept>

namespace tessera::scenes {

ordered_json json(const Vec& v) { return {v.x, v.y, v.z}; }

ordered_json camera(const Vec& from, const Vec& to, double fov) {
  return {{"look_at", {{"from", json(from)}, {"to", json(to)}}}, {"vertical_fov", fov}};
}

ordered_json color(const Vec& c) { return {{"color", json(c)}}; }

ordered_json metal(const char* name, double roughness) {
  return {{"type", "metal"}, {"metal", name}, {"roughness", roughness}};
}

void add_sheet(ordered_json& scene, const std::string& name, const char* material, const Vec& corner,
               const Vec& u, const Vec& v, double repeats) {
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
  return scene;
}

void add_tiles(ordered_json& scene, double roughness) {
  scene["materials"]["tiles"] = {
      {"type", "plastic"}, {"color_texture", "tiles.png"}, {"roughness", roughness}};
}

ordered_json terrace(const char* name) {
  ordered_json scene = empty_scene(name, camera({-2.2, 1.6, 5.5}, {0.2, 0.9, 0}, 42));
  scene["environment"] = {{"image", "sky.hdr"}, {"rotation", 40}};
  scene["lights"] = {{{"type", "directional"},
                      {"direction", {-0.6, -0.7, -0.5}},
                      {"irradiance", {3.6, 3.1, 2.3}},
                      {"angular_diameter", 0.53}}};
  scene["materials"] = {{"plaster", color({0.75, 0.7, 0.62})},
                        {"leaf", color({0.12, 0.3, 0.07})},
                        {"steel", metal("chromium", 0.12)}};
  add_tiles(scene, 0.3);
  add_sheet(scene, "floor", "tiles", {-6, 0, 6}, {12, 0, 0}, {0, 0, -12}, 16);
  add_box(scene, "wall", "plaster", {-3, 0, -2.2}, {1.2, 1.9, -1.9});
  for (int i = 0; i < 5; ++i)
    add_box(scene, "post" + std::to_string(i), "plaster", {1.5 + 0.45 * i, 0, -2.2},
            {1.62 + 0.45 * i, 1.7, -2.08});
  add_sphere(scene, {-1.2, 0.6, -0.6}, 0.6, "leaf");
  add_sphere(scene, {0.7, 0.45, 0.6}, 0.45, "steel");
  return scene;
}

void write(const ordered_json& scene, const std::filesystem::path& folder, std::string_view name) {
  std::ofstream file(folder / (std::string(name) + ".json"));
  file << scene.dump(1) << '\n';
  if (!file.flush()) throw std::runtime_error("cannot write " + (folder / name).string());
}

}  // namespace tessera::scenes
