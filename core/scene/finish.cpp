// SPDX-License-Identifier: Apache-2.0
#include "core/scene/finish.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/error.h"
#include "core/scene/finish_parts.h"
#include "core/scene/framing.h"
#include "core/scene/import.h"

namespace tessera {
namespace finishing {

void Context::warn(std::string_view what) const { tessera::warn(scene, fmt::format("{}: {}", file, what)); }

void Context::refuse(std::string_view what, std::string_view accepted) const {
  throw InputError(file, what, accepted);
}

void Context::clamp(float& value, float low, float high, std::string_view owner,
                    std::string_view field) const {
  if (value >= low && value <= high) return;
  const float clamped = std::isnan(value) ? low : std::clamp(value, low, high);
  warn(fmt::format("{}: {} {:g} is taken for {:g}", owner, field, value, clamped));
  value = clamped;
}

void Context::clamp(Color& color, float low, float high, std::string_view owner,
                    std::string_view field) const {
  for (int c = 0; c < 3; ++c) clamp(color[c], low, high, owner, field);
}

void Context::require_index(int index, std::size_t size, bool optional, std::string_view owner,
                            std::string_view thing) const {
  if (index == -1 && optional) return;
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    refuse(fmt::format("{}: there is no {} {}", owner, thing, index), fmt::format("below {}", size));
}

void Context::require_light(LightTraits& light, std::string_view owner) const {
  require_index(light.group, scene.light_groups.size(), true, owner, "light group");
  clamp(light.diffuse, 0, kMaxPower, owner, "the diffuse factor of the light");
  clamp(light.specular, 0, kMaxPower, owner, "the specular factor of the light");
}

bool Context::unusable(std::string_view thing, bool usable) const {
  if (!usable) warn(fmt::format("{} that is not finite or has no size is left out", thing));
  return !usable;
}

bool finite(const Vec3& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

bool finite(const Matrix& m) {
  for (int i = 0; i < 16; ++i)
    if (!std::isfinite(m[i / 4][i % 4])) return false;
  return true;
}

bool is_direction(const Vec3& v) { return std::abs(v.length() - 1) < 1e-3f; }

}  // namespace finishing

void finish(Scene& scene, const std::string& file) {
  const finishing::Context context{scene, file};
  if (scene.light_groups.size() > kMaxLightGroups)
    context.refuse(fmt::format("there are {} light groups", scene.light_groups.size()),
                   fmt::format("at most {}", kMaxLightGroups));
  if (!(scene.frames_per_second > 0 && scene.frames_per_second <= 1e6f))
    context.refuse(fmt::format("there are {} frames a second", scene.frames_per_second),
                   "above 0, at most 1e6");
  finish_materials(context);
  finish_geometry(context);
  finish_lights(context);
  finish_cameras(context);
  if (scene.cameras.empty()) scene.cameras.push_back(framing_camera(scene));
  if (scene.instances.empty() && scene.spheres.empty() && scene.quads.empty() && scene.disks.empty())
    context.warn("there is nothing to see: no triangles, spheres, quads or disks");
}

}  // namespace tessera
