// SPDX-License-Identifier: Apache-2.0
#include "core/scene/facts.h"

#include <cmath>
#include <numbers>
#include <set>

#include "core/scene/framing.h"

namespace tessera {
namespace {

double luminance(const Color& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; }

// Radiance of the material's surface, textures counted as white.
double emitted(const Scene& scene, int material, int depth = 0) {
  const auto index = static_cast<std::size_t>(material);
  if (material < 0 || index >= scene.materials.size() || depth > kMaxMixDepth) return 0;
  const Material& m = scene.materials[index];
  if (m.kind == Material::Kind::mix)
    return std::lerp(emitted(scene, m.first, depth + 1), emitted(scene, m.second, depth + 1), double(m.mix));
  return luminance(m.emission);
}

std::set<int> materials_in_use(const Scene& scene) {
  std::set<int> used;
  for (const Instance& i : scene.instances)
    used.insert(scene.meshes[static_cast<std::size_t>(i.mesh)].material);
  for (const Sphere& s : scene.spheres) used.insert(s.material);
  for (const Quad& q : scene.quads) used.insert(q.material);
  for (const Disk& d : scene.disks) used.insert(d.material);
  return used;
}

class Mean {
 public:
  void add(double luminance) {
    if (luminance > 0 && std::isfinite(luminance)) sum_ += luminance, ++count_;
  }
  double value() const { return count_ > 0 ? sum_ / count_ : 0; }

 private:
  double sum_ = 0;
  int count_ = 0;
};

double mean_light(const Scene& scene, double diameter) {
  Mean mean;
  for (const int m : materials_in_use(scene)) mean.add(emitted(scene, m));
  mean.add(luminance(scene.environment.radiance));
  // Of white paper in that light.
  for (const DirectionalLight& s : scene.suns) mean.add(luminance(s.irradiance) / std::numbers::pi);
  const double away = diameter > 0 ? diameter / 2 : 1;
  for (const PointLight& p : scene.points)
    mean.add(luminance(p.intensity) / (std::numbers::pi * away * away));
  for (const SpotLight& s : scene.spots) mean.add(luminance(s.intensity) / (std::numbers::pi * away * away));
  return mean.value();
}

}  // namespace

SceneFacts facts_of(const Scene& scene) {
  const Imath::Box3f bounds = bounds_of(scene);
  const double diameter = bounds.isEmpty() ? 0 : double(bounds.size().length());
  return {.diameter = diameter, .light = mean_light(scene, diameter)};
}

}  // namespace tessera
