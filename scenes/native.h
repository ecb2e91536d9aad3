// SPDX-License-Identifier: Apache-2.0
// Words in which small scenes of the native format are put together, and rooms that several of them share.
#pragma once

#include <Imath/ImathVec.h>

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>

namespace tessera::scenes {

using nlohmann::ordered_json;
using Vec = Imath::V3d;

ordered_json json(const Vec&);
ordered_json camera(const Vec& from, const Vec& to, double fov);
ordered_json color(const Vec&);
ordered_json metal(const char* name, double roughness);

// A rectangle; with `repeats`, its texture coordinates go up to that.
void add_sheet(ordered_json& scene, const std::string& name, const char* material, const Vec& corner,
               const Vec& u, const Vec& v, double repeats = 0);
void add_box(ordered_json& scene, const std::string& name, const char* material, const Vec& low,
             const Vec& high);
void add_sphere(ordered_json& scene, const Vec& center, double radius, const std::string& material);
// A lamp that shines down, or along u x v.
void add_lamp(ordered_json& scene, const Vec& corner, const Vec& u, const Vec& v, const Vec& radiance);
// The material "tiles", of tiles.png: see paint.h.
void add_tiles(ordered_json& scene, double roughness);

ordered_json empty_scene(const char* name, ordered_json view);
// Two metres each way, open towards the camera. Without a lamp.
ordered_json box_room(const char* name);
// A terrace with a wall, posts and two balls, under the sky and the sun. Wants tiles.png and sky.hdr.
ordered_json terrace(const char* name);

// FOLDER/NAME.json
void write(const ordered_json& scene, const std::filesystem::path& folder, std::string_view name);

}  // namespace tessera::scenes
