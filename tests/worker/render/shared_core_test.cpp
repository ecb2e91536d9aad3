// SPDX-License-Identifier: Apache-2.0
// What Embree builds is shared between scenes of the same shapes, and only between those; and nothing of it
// shows.
#include <gtest/gtest.h>

#include <set>

#include "core/scene/scene.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/bvh.h"
#include "worker/render/render.h"

namespace tessera {
namespace {

// A floor with holes by chance, a wall, a ball.
Scene room() {
  Scene scene;
  scene.materials = {{.name = "white", .base_color = {0.8f, 0.8f, 0.8f}},
                     {.name = "red", .base_color = {0.8f, 0.1f, 0.1f}},
                     {.name = "veil",
                      .base_color = {0.5f, 0.5f, 0.9f},
                      .alpha = Material::Alpha::blend,
                      .base_alpha = 0.5f}};
  testing::add_mesh(scene, testing::grid(Vec3(-3, 0, 2), Vec3(6, 0, 0), Vec3(0, 0, -8), 1, 2));
  testing::add_mesh(scene, testing::grid(Vec3(-3, 0, -4), Vec3(6, 0, 0), Vec3(0, 4, 0), 1, 0));
  scene.spheres.push_back({.center = Vec3(0, 1, -2), .radius = 0.8f, .material = 1});
  scene.environment.radiance = {1, 1, 1};
  scene.cameras = {testing::camera_at(Vec3(0, 1.2f, 3), Vec3(0, 1, 0), 0.8f)};
  scene.variants = {{"red walls", {{1, 1}}}, {"veiled walls", {{1, 2}}}};
  return scene;
}

class Kept {
 public:
  std::shared_ptr<const RenderScene> prepare(const Scene& scene, const std::string& variant = "") {
    RenderSettings settings;
    settings.variant = variant;
    return tessera::prepare(std::make_shared<const Scene>(scene), settings, 0, nullptr,
                            [this](const tracer::Geometry& g, const std::function<bool(int)>& masked) {
                              const auto core = kept_(g, masked);
                              cores_.insert(core);
                              return core;
                            });
  }
  std::size_t cores() const { return cores_.size(); }

 private:
  tracer::CoreSource kept_ = tracer::kept_cores(8);
  std::set<std::shared_ptr<const tracer::BvhCore>> cores_;
};

Image seen(const RenderScene& scene, const std::string& variant = "") {
  RenderSettings settings{.size = {40, 30}, .max_bounces = 3};
  settings.variant = variant;
  return render(scene, settings, 0, {0, 0, 40, 30}, {0, 8}).sums;
}

TEST(SharedCore, AnotherMaterialVariantLightOrCameraBuildsNothing) {
  Kept kept;
  Scene scene = room();
  kept.prepare(scene);
  kept.prepare(scene, "red walls");
  scene.materials[0].base_color = {0.1f, 0.2f, 0.3f};
  scene.materials[1].emission = {3, 3, 3};
  scene.environment.radiance = {2, 1, 0};
  scene.cameras[0].to_world.setTranslation(Vec3(1, 1, 3));
  kept.prepare(scene);
  EXPECT_EQ(kept.cores(), 1u);
}

TEST(SharedCore, AnotherShapeVisibilityOrMaskBuildsAnew) {
  Kept kept;
  kept.prepare(room());
  const auto with = [&](auto&& change) {
    Scene scene = room();
    change(scene);
    const std::size_t before = kept.cores();
    kept.prepare(scene);
    return kept.cores() - before;
  };
  EXPECT_EQ(with([](Scene& s) { s.meshes[0].positions[0].y = 0.001f; }), 1u);
  EXPECT_EQ(with([](Scene& s) { s.meshes[1].triangles.pop_back(); }), 1u);
  EXPECT_EQ(with([](Scene& s) { s.spheres[0].radius = 0.81f; }), 1u);
  EXPECT_EQ(with([](Scene& s) { s.instances[1].to_world.setTranslation(Vec3(0, 0, 1)); }), 1u);
  EXPECT_EQ(with([](Scene& s) { s.instances.push_back({1, Matrix()}); }), 1u);
  EXPECT_EQ(with([](Scene& s) { s.meshes[1].material = 2; }), 1u);  // it has holes now
  EXPECT_EQ(with([](Scene&) {}), 0u);
}

TEST(SharedCore, DoesNotShowInTheImage) {
  Kept kept;
  const auto plain = kept.prepare(room()), red = kept.prepare(room(), "red walls"),
             veiled = kept.prepare(room(), "veiled walls");
  EXPECT_EQ(kept.cores(), 2u);
  for (const auto& [scene, variant] :
       {std::pair{plain, ""}, std::pair{red, "red walls"}, std::pair{veiled, "veiled walls"}}) {
    RenderSettings settings;
    settings.variant = variant;
    const auto alone = prepare(std::make_shared<const Scene>(room()), settings);
    EXPECT_EQ(seen(*scene, variant), seen(*alone, variant)) << variant;
  }
  EXPECT_NE(seen(*plain), seen(*red, "red walls"));
}

TEST(SharedCore, OutlivesTheSceneItWasBuiltOf) {
  Kept kept;
  Scene other = room();
  other.materials[0].base_color = {0.2f, 0.4f, 0.1f};
  auto first = kept.prepare(room());
  const auto second = kept.prepare(other);
  first.reset();
  EXPECT_EQ(seen(*second), seen(*prepare(std::make_shared<const Scene>(other))));
}

}  // namespace
}  // namespace tessera
