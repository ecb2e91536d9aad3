// SPDX-License-Identifier: Apache-2.0
// The steps of finish.cpp, and what they have in common. Only for the finish*.cpp files.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

#include "core/scene/scene.h"

namespace tessera::finishing {

inline constexpr float kMaxPower = 1e12f;  // of lights and emission: products with it stay finite

struct Context {
  Scene& scene;
  const std::string& file;

  void warn(std::string_view what) const;
  [[noreturn]] void refuse(std::string_view what, std::string_view accepted = {}) const;

  // Pulls a value into a range, with a warning; NaN becomes `low`. `owner` is "material 'gold'".
  void clamp(float& value, float low, float high, std::string_view owner, std::string_view field) const;
  void clamp(Color& color, float low, float high, std::string_view owner, std::string_view field) const;

  // Throws InputError unless index is -1, where that is allowed, or below size.
  void require_index(int index, std::size_t size, bool optional, std::string_view owner,
                     std::string_view thing) const;
  void require_light(LightTraits& light, std::string_view owner) const;

  // True, with a warning, if a thing is to be left out.
  bool unusable(std::string_view thing, bool usable) const;
};

bool finite(const Vec3& v);
bool finite(const Matrix& m);
bool is_direction(const Vec3& v);  // of length 1

void finish_materials(const Context&);
void finish_geometry(const Context&);  // meshes, tracks, objects, instances, shapes
void finish_lights(const Context&);
void finish_cameras(const Context&);

}  // namespace tessera::finishing
