// SPDX-License-Identifier: Apache-2.0
#include "scenes/courtyard.h"

#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>
#include <numbers>

#include "scenes/ornaments.h"
#include "scenes/paint.h"
#include "scenes/shapes.h"

namespace tessera::scenes {
namespace {

using nlohmann::ordered_json;

constexpr float kPi = std::numbers::pi_v<float>;
constexpr float kHalf = 6.0f;            // metres, half the edge of the court between the arcades
constexpr float kBay = 2.4f;             // from column to column
constexpr int kBays = 5;                 // a side
constexpr float kTop = 4.3f;             // of the walls
constexpr float kDepth = 2.6f;           // of the walk behind the arches
const Vec3 kToSun(0.72f, 0.42f, 0.38f);  // low, from the right and behind the camera

ordered_json json_of(const Vec3& v) { return ordered_json::array({v.x, v.y, v.z}); }

class Courtyard {
 public:
  explicit Courtyard(const std::filesystem::path& folder) : folder_(folder) {}

  void write() {
    std::filesystem::create_directories(folder_);
    paint_tiles(folder_);
    paint_ripples(folder_);
    paint_sky(folder_, std::atan2(kToSun.x, -kToSun.z));
    describe_view_and_light();
    describe_materials();
    build_ground();
    build_arcades();
    build_basin();
    build_plants();
    build_bench();
    std::ofstream(folder_ / "courtyard.json") << scene_.dump(1) << "\n";
  }

 private:
  void mesh(const std::string& name, const std::string& material, const Shape& shape) {
    write_obj(shape, folder_ / (name + ".obj"));
    scene_["meshes"][name] = {{"file", name + ".obj"}, {"material", material}};
  }

  void place(const std::string& mesh, const Vec3& at, float turn = 0, float scale = 1) {
    ordered_json transform{{"translate", json_of(at)}};
    if (turn != 0) transform["rotate"] = json_of({0, turn, 0});
    if (scale != 1) transform["scale"] = scale;
    scene_["instances"].push_back({{"mesh", mesh}, {"transform", transform}});
  }

  void sphere(const Vec3& center, float radius, const std::string& material) {
    scene_["spheres"].push_back({{"center", json_of(center)}, {"radius", radius}, {"material", material}});
  }

  void describe_view_and_light() {
    scene_["name"] = "Courtyard in the evening";
    scene_["camera"] = {{"look_at", {{"from", {2.7, 1.65, 7.5}}, {"to", {0.45, 1.5, -2.5}}}},
                        {"horizontal_fov", 66},
                        {"lens_radius", 0.008},
                        {"focus_distance", 7.5}};
    scene_["lights"].push_back({{"type", "directional"},
                                {"direction", json_of(-kToSun)},
                                {"irradiance", {6.0, 3.6, 1.8}},
                                {"angular_diameter", 0.53}});
    scene_["environment"] = {{"image", "sky.hdr"}, {"radiance", 0.8}};
  }

  void describe_materials() {
    auto& m = scene_["materials"];
    m["stucco"] = {{"color", {0.74, 0.62, 0.48}}};
    m["stone"] = {{"color", {0.60, 0.54, 0.46}}};
    m["wood"] = {{"color", {0.22, 0.12, 0.06}}};
    m["earth"] = {{"color", {0.30, 0.24, 0.14}}};
    m["terracotta"] = {{"color", {0.52, 0.23, 0.12}}};
    m["bark"] = {{"color", {0.16, 0.10, 0.06}}};
    m["orange leaf"] = {{"color", {0.09, 0.22, 0.05}}};
    m["agave leaf"] = {{"color", {0.17, 0.30, 0.22}}};
    m["cypress leaf"] = {{"color", {0.05, 0.12, 0.04}}};
    m["orange"] = {{"type", "metallic_roughness"}, {"color", {0.90, 0.36, 0.03}}, {"roughness", 0.45}};
    m["tiles"] = {{"type", "metallic_roughness"},
                  {"color", 1},
                  {"color_texture", "tiles.png"},
                  {"normal_texture", "tiles_normal.png"},
                  {"metallic_roughness_texture", "tiles_rough.png"}};
    m["water"] = {{"type", "metallic_roughness"},
                  {"color", {0.02, 0.07, 0.07}},
                  {"roughness", 0.2},
                  {"ior", 1.33},
                  {"normal_texture", "ripples.png"}};
    m["brass"] = {
        {"type", "metal"}, {"roughness", 0.32}, {"eta", {0.444, 0.527, 1.094}}, {"k", {3.695, 2.765, 1.829}}};
    m["flame"] = {{"color", 0.5}, {"emission", {60, 34, 14}}};
    m["polished brass"] = {
        {"type", "metal"}, {"roughness", 0.2}, {"eta", {0.444, 0.527, 1.094}}, {"k", {3.695, 2.765, 1.829}}};
    m["green glaze"] = {{"type", "metallic_roughness"}, {"color", {0.05, 0.35, 0.20}}, {"roughness", 0.15}};
    m["amber glaze"] = {{"type", "metallic_roughness"}, {"color", {0.60, 0.25, 0.03}}, {"roughness", 0.15}};
  }

  void build_ground() {
    mesh("earth", "earth", sheet({kHalf + 0.5f, -0.02f, 8.6f}, {4.5f, 0, 0}, {0, 0, -18}));
    // One repeat of the tile is 0.64 m.
    const float low = -kHalf - kDepth, size = kHalf + 0.5f - low, length = 8.6f - low;
    Shape floor = sheet({low, 0, low + length}, {size, 0, 0}, {0, 0, -length});
    for (Vec2& uv : floor.uvs) uv /= 0.64f;
    mesh("floor", "tiles", floor);
    Shape wall = box({kHalf + 0.2f, 0, -kHalf}, {kHalf + 0.6f, 1.4f, 8.6f});
    wall.add(box({kHalf + 0.12f, 1.4f, -kHalf}, {kHalf + 0.68f, 1.5f, 8.6f}));
    mesh("garden_wall", "stucco", wall);
  }

  void build_arcades() {
    mesh("column", "stone", column());
    mesh("arch", "stucco", arch(kBay, 2 * 0.95f, kTop - kSpringing, 0.44f, 40));
    mesh("lantern", "brass", lantern());
    mesh("walk", "stucco", walk());
    mesh("dado", "tiles", dado());
    mesh("beams", "wood", beams());
    for (int side = 0; side < 2; ++side) {
      const float turn = side == 0 ? 0.0f : 90.0f;
      const auto at = [&](float along, float y, float out) {  // out: from the line of the columns outward
        return side == 0 ? Vec3(along, y, -kHalf - out) : Vec3(-kHalf - out, y, -along);
      };
      for (int b = 0; b < kBays; ++b) {
        const float along = (static_cast<float>(b) - 0.5f * (kBays - 1)) * kBay;
        place("arch", at(along, kSpringing, 0), turn);
        if (b % 2 != side) continue;
        place("lantern", at(along, kSpringing + 0.95f, 0));
        sphere(at(along, kSpringing + 0.95f + kGlobe, 0), kGlobeRadius, "flame");
      }
      for (int c = side; c <= kBays; ++c)  // the corner column belongs to the first side
        place("column", at((static_cast<float>(c - side) - 0.5f * kBays) * kBay, 0, 0));
      place("walk", {0, 0, 0}, turn);
      place("dado", {0, 0, 0}, turn);
      place("beams", {0, 0, 0}, turn);
    }
  }

  // Back wall, ceiling and cornice behind the arches of the far side.
  static Shape walk() {
    const float back = -kHalf - kDepth;
    Shape shape = box({-kHalf - kDepth, 0, back - 0.3f}, {kHalf + 0.6f, kTop, back});
    shape.add(box({-kHalf - kDepth, kTop, back - 0.3f}, {kHalf + 0.6f, kTop + 0.25f, -kHalf + 0.34f}));
    shape.add(box({kHalf + 0.3f, 0, back}, {kHalf + 0.6f, kTop, -kHalf - 0.22f}));
    shape.add(box({-kHalf - 0.22f, kTop - 0.14f, -kHalf + 0.22f}, {kHalf + 0.22f, kTop, -kHalf + 0.30f}));
    return shape;
  }

  static Shape dado() {
    Shape shape =
        sheet({-kHalf - kDepth, 0, -kHalf - kDepth + 0.02f}, {2 * kHalf + kDepth + 0.6f, 0, 0}, {0, 1.2f, 0});
    for (Vec2& uv : shape.uvs) uv /= 0.4f;
    return shape;
  }

  static Shape beams() {
    Shape shape =
        box({-kHalf - kDepth, 1.2f, -kHalf - kDepth}, {kHalf + 0.6f, 1.28f, -kHalf - kDepth + 0.06f});
    for (float x = -kHalf - kDepth + 0.3f; x < kHalf; x += 0.6f)
      shape.add(box({x, kTop - 0.2f, -kHalf - kDepth}, {x + 0.14f, kTop, -kHalf - 0.2f}));
    return shape;
  }

  void build_basin() {
    constexpr float w = 1.9f, l = 2.5f, z = -0.5f, rim = 0.3f, h = 0.4f;
    Shape stone = box({-w, 0, z - l}, {w, h, z - l + rim});
    stone.add(box({-w, 0, z + l - rim}, {w, h, z + l}));
    stone.add(box({-w, 0, z - l + rim}, {-w + rim, h, z + l - rim}));
    stone.add(box({w - rim, 0, z - l + rim}, {w, h, z + l - rim}));
    mesh("basin", "stone", stone);
    Shape water = sheet({-w + rim, 0.3f, z + l - rim}, {2 * (w - rim), 0, 0}, {0, 0, -2 * (l - rim)});
    for (Vec2& uv : water.uvs) uv /= 1.5f;
    mesh("water", "water", water);
    mesh("fountain", "stone",
         lathe({{0.34f, 0},
                {0.34f, 0.36f},
                {0.34f, 0.36f},
                {0.20f, 0.42f},
                {0.13f, 0.55f},
                {0.11f, 0.75f},
                {0.14f, 0.95f},
                {0.30f, 1.02f},
                {0.58f, 1.12f},
                {0.68f, 1.22f},
                {0.70f, 1.27f},
                {0.66f, 1.27f},
                {0.60f, 1.21f},
                {0.0f, 1.20f}},
               64));
    mesh("bowl_water", "water", lathe({{0.62f, 1.235f}, {0.0f, 1.235f}}, 48));
    mesh("finial", "brass",
         lathe({{0.10f, 1.2f},
                {0.06f, 1.3f},
                {0.035f, 1.42f},
                {0.05f, 1.5f},
                {0.11f, 1.56f},
                {0.13f, 1.64f},
                {0.11f, 1.72f},
                {0.05f, 1.78f},
                {0.02f, 1.86f},
                {0.0f, 1.94f}},
               40));
    for (const char* name : {"fountain", "bowl_water", "finial"}) place(name, {0, 0, z});
  }

  void build_plants() {
    mesh("pot", "terracotta",
         lathe({{0.0f, 0},
                {0.24f, 0},
                {0.27f, 0.04f},
                {0.34f, 0.42f},
                {0.34f, 0.42f},
                {0.39f, 0.43f},
                {0.40f, 0.52f},
                {0.36f, 0.52f},
                {0.34f, 0.46f},
                {0.0f, 0.46f}},
               48));
    mesh("trunk", "bark",
         lathe({{0.06f, 0.4f}, {0.045f, 0.8f}, {0.04f, 1.2f}, {0.05f, 1.7f}, {0.0f, 1.9f}}, 16));
    mesh("crown", "orange leaf", foliage({0.72f, 0.62f, 0.72f}, 1100, 0.15f, 11));
    mesh("agave", "agave leaf", rosette());
    mesh("cypress", "cypress leaf", foliage({0.75f, 3.0f, 0.75f}, 2600, 0.28f, 23));
    Dice dice(5);
    for (const Vec3& at : {Vec3(-3.1f, 0, -3.6f), Vec3(3.1f, 0, -3.6f), Vec3(-3.1f, 0, 2.5f)}) {
      place("pot", at);
      place("trunk", at);
      place("crown", at + Vec3(0, 2.05f, 0), dice.between(0, 360));
      for (int i = 0; i < 22; ++i) {
        const float y = dice.between(-0.8f, 0.7f), around = dice.between(0, 2 * kPi),
                    flat = 0.70f * std::sqrt(1 - y * y);
        sphere(at + Vec3(flat * std::cos(around), 2.05f + 0.6f * y, flat * std::sin(around)), 0.045f,
               "orange");
      }
    }
    for (int c = 0; c <= kBays; ++c) {
      const float along = (static_cast<float>(c) - 0.5f * kBays) * kBay;
      for (const Vec3& at : {Vec3(along, 0, -kHalf + 0.75f), Vec3(-kHalf + 0.75f, 0, along)}) {
        if (c == 0) continue;
        place("pot", at, 0, 0.7f);
        place("agave", at + Vec3(0, 0.33f, 0), dice.between(0, 360), dice.between(0.8f, 1.1f));
      }
    }
    for (const Vec3& at :
         {Vec3(8.2f, 2.9f, -7.0f), Vec3(9.0f, 2.7f, -4.2f), Vec3(8.4f, 2.8f, -1.2f), Vec3(9.2f, 2.6f, 5.2f)})
      place("cypress", at, dice.between(0, 360), dice.between(0.9f, 1.05f));
  }

  // With a ball of brass and two of glazed clay; the light that glass throws about would take hours to
  // settle.
  void build_bench() {
    Shape bench = box({5.45f, 0.42f, -3.4f}, {5.95f, 0.5f, 0.0f});
    for (const float z : {-3.2f, -1.8f, -0.4f}) bench.add(box({5.5f, 0, z}, {5.9f, 0.42f, z + 0.2f}));
    mesh("bench", "wood", bench);
    sphere({5.68f, 0.5f + 0.17f, -1.5f}, 0.17f, "polished brass");
    sphere({5.70f, 0.5f + 0.13f, -1.95f}, 0.13f, "green glaze");
    sphere({5.62f, 0.5f + 0.10f, -1.15f}, 0.10f, "amber glaze");
  }

  std::filesystem::path folder_;
  ordered_json scene_;
};

}  // namespace

void write_courtyard(const std::filesystem::path& folder) { Courtyard(folder).write(); }

}  // namespace tessera::scenes
