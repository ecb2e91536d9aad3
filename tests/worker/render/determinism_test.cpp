// SPDX-License-Identifier: Apache-2.0
// The bits of a sample do not depend on how the work was cut.
#include <gtest/gtest.h>
#include <pmmintrin.h>

#include <random>
#include <thread>

#include "tests/worker/render/scenes.h"

namespace tessera {
namespace {

using namespace testing;

const Size kFrame{37, 29};
const Region kWhole{0, 0, kFrame.width, kFrame.height};

// Grids of different fineness in one plane, under a sun and a sky: nearly every ray ties.
Scene coplanar() {
  Scene scene;
  scene.cameras = {camera_at({0, 2, 3}, {0, 0, 0}, 1.0f)};
  const Color colors[] = {{0.9f, 0.1f, 0.1f}, {0.1f, 0.9f, 0.1f}, {0.1f, 0.1f, 0.9f}};
  for (int i = 0; i < 3; ++i) {
    const int material = add_material(scene, {.base_color = colors[i]});
    add_mesh(scene, grid({-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, 40 + 7 * i, material));
    add_mesh(scene, grid({-3, 0, -2}, {6, 0, 0}, {0, 4, 0}, 31 + 5 * i, material));
  }
  // Twice the same mesh, so that instances tie too.
  scene.instances.push_back({0, Matrix().translate(Vec3(0.5f, 0, 0))});
  scene.suns.push_back({Vec3(0.3f, -1, -0.2f).normalized(), {3, 3, 3}, 0.01f});
  scene.environment.radiance = Color(0.5f, 0.6f, 0.7f);
  return scene;
}

// One picture of everything that takes randomness, memory or a choice on its way: textures, mixes, coats,
// glass, blends, lights of all kinds and more of them than one, what moves, a lens, a catcher, light groups.
int add_picture(Scene& scene, int channels) {
  Picture p{"noise", 16, 8, channels, {}};
  std::mt19937 engine(5);
  for (int i = 0; i < 16 * 8 * channels; ++i)
    p.pixels.push_back(static_cast<float>(engine() >> 8) * 0x1p-24f);
  scene.pictures.push_back(std::move(p));
  return static_cast<int>(scene.pictures.size()) - 1;
}

void add_surfaces(Scene& scene) {
  using enum Material::Kind;
  const Texture noise{.picture = add_picture(scene, 4)};
  Material gltf{.kind = metallic_roughness, .base_color_texture = noise, .metallic_roughness_texture = noise};
  gltf.normal_texture = gltf.sheen_color_texture = gltf.clearcoat_texture = noise;
  gltf.metallic = gltf.transmission = gltf.clearcoat = 0.5f;
  gltf.sheen_color = Color(0.3f, 0.2f, 0.1f);
  Material veil{.kind = translucent, .base_color_texture = noise, .alpha = Material::Alpha::blend};
  veil.transmission_color = Color(0.1f, 0.2f, 0.1f);
  const Material solid{.kind = glass,
                       .roughness = 0.2f,
                       .attenuation_color = Color(0.5f, 0.9f, 0.3f),
                       .attenuation_distance = 1};
  const int first = add_material(scene, {.kind = plastic, .base_color_texture = noise, .roughness = 0.3f});
  for (const Material& m : {gltf, veil, solid, Material{.kind = unlit}}) add_material(scene, m);
  const int mixed = add_material(
      scene, {.kind = mix, .first = first, .second = first + 1, .mix = 0.6f, .mix_texture = noise});
  add_mesh(scene, grid({-3, 0.01f, 3}, {6, 0, 0}, {0, 0, -6}, 3, mixed));
  add_mesh(scene, grid({-1, 0.2f, 1}, {1, 0, 0}, {0, 1, -1}, 2, first + 2));
  scene.spheres.push_back({{0.8f, 0.5f, 0.8f}, 0.5f, first + 3});
  scene.quads.push_back({{-2, 0, 0.5f}, {0.5f, 0, 0}, {0, 1, 0}, first + 4});
}

void add_lights(Scene& scene) {
  scene.light_groups = {"warm", "cold"};
  const int lamp = add_material(scene, {.emission = Color(4, 3, 2)});
  const int lit = static_cast<int>(scene.objects.size());
  scene.objects.push_back({.name = "lit", .light = {.group = 0, .diffuse = 0.5f}});
  scene.quads.push_back({{-1, 3, -1}, {1, 0, 0}, {0, 0, 1}, lamp, lit});
  scene.disks.push_back({{1, 3, 0}, {0, -1, 0}, 0.3f, lamp, lit});
  scene.spheres.push_back({{1.5f, 1.5f, -1}, 0.2f, lamp, lit});
  for (int i = 0; i < 12; ++i)
    scene.points.push_back({{static_cast<float>(i) / 2 - 3, 2, 1}, {0.2f, 0.1f, 0.3f}, {.group = 1}});
  scene.spots.push_back({{0, 3, 2}, {0, -1, 0}, {2, 2, 2}, 0.2f, 0.5f});
  scene.environment.picture = add_picture(scene, 3);
}

Scene everything() {
  Scene scene = coplanar();
  add_surfaces(scene);
  add_lights(scene);
  scene.tracks = {{{0, 1}, {Matrix(), Matrix().translate(Vec3(2, 1, 0))}},
                  {{0, 1}, {Matrix(), Matrix().translate(Vec3(-1, 0, 0))}}};
  scene.frames_per_second = 4;
  scene.objects.push_back({.name = "moving", .track = 0});
  scene.objects.push_back({.name = "catcher", .catcher = true});
  scene.instances[scene.instances.size() - 1].object = 1;
  scene.instances[4].object = 2;
  Camera& camera = scene.cameras[0];
  camera.lens_radius = 0.05f, camera.focus_distance = 3, camera.blades = 5;
  camera.shutter_open = 0, camera.shutter_close = 0.5f, camera.track = 1;
  return scene;
}

RenderSettings settings() { return {.size = kFrame, .seed = 7, .max_bounces = 3, .aovs = all_aovs()}; }

std::shared_ptr<const RenderScene> ready(const Scene& scene, int frame) {
  return prepare(std::make_shared<const Scene>(scene), settings(), frame);
}

// What both scenes promise.
class SameBits : public ::testing::TestWithParam<Scene (*)()> {
 protected:
  const Scene scene_ = GetParam()();
};
INSTANTIATE_TEST_SUITE_P(Render, SameBits, ::testing::Values(coplanar, everything), [](const auto& which) {
  return std::string(which.param == coplanar ? "Ties" : "Everything");
});

TEST_P(SameBits, ForAnySplitOfTheRegion) {
  const auto scene = ready(scene_, 3);
  const Image whole = render(*scene, settings(), 3, kWhole, {0, 8}).sums;
  for (const Size tile : {Size{1, 1}, Size{5, 3}, Size{16, 16}, Size{37, 1}, Size{13, 29}}) {
    Image pieces(kWhole, whole.planes());
    for (const Region& r : grid_cells(kWhole, tile))
      paste(pieces, render(*scene, settings(), 3, r, {0, 8}).sums);
    EXPECT_TRUE(same_bits(pieces, whole)) << tile.width << " x " << tile.height;
  }
}

TEST_P(SameBits, ForAnySplitOfTheSamples) {
  const auto scene = ready(scene_, 0);
  const Region part{3, 2, 20, 17};
  const Block whole = render(*scene, settings(), 0, part, {32, 64});
  for (const int length : {8, 16}) {
    std::vector<Block> blocks;
    for (const SampleRange& r : dyadic_blocks({32, 64}, length))
      blocks.push_back(render(*scene, settings(), 0, part, r));
    while (blocks.size() > 1) {
      std::vector<Block> joined;
      for (std::size_t i = 0; i < blocks.size(); i += 2) {
        join(blocks[i], blocks[i + 1], FilmLayout(settings().aovs));
        joined.push_back(std::move(blocks[i]));
      }
      blocks = std::move(joined);
    }
    EXPECT_EQ(blocks[0].samples, whole.samples);
    EXPECT_TRUE(same_bits(blocks[0].sums, whole.sums)) << "leaves of " << length;
  }
}

TEST_P(SameBits, InEveryThreadAndForEveryPreparationOfTheScene) {
  const Image whole = render(*ready(scene_, 0), settings(), 0, kWhole, {0, 8}).sums;
  const auto scene = ready(scene_, 0);
  std::vector<Image> images(3);
  std::vector<std::thread> threads;
  for (Image& image : images)
    threads.emplace_back([&] { image = render(*scene, settings(), 0, kWhole, {0, 8}).sums; });
  for (std::thread& t : threads) t.join();
  for (const Image& image : images) EXPECT_TRUE(same_bits(image, whole));
}

TEST(Render, PixelsBeyondTheFrameAreTracedButNotKept) {
  RenderSettings larger = settings();
  const auto scene = prepared(coplanar());
  const Region corner{36, 28, 37, 29};
  const Image alone = render(*scene, settings(), 0, corner, {0, 8}).sums;
  EXPECT_EQ(alone.region(), corner);
  EXPECT_TRUE(same_bits(alone, cropped(render(*scene, larger, 0, kWhole, {0, 8}).sums, corner)));
}

TEST(Render, SeedFrameAndSampleIndexEachChangeTheSamples) {
  const auto scene = prepared(coplanar());
  const Region part{8, 8, 16, 16};
  const Image first = render(*scene, settings(), 0, part, {0, 8}).sums;
  RenderSettings reseeded = settings();
  reseeded.seed = 8;
  EXPECT_FALSE(same_bits(first, render(*scene, reseeded, 0, part, {0, 8}).sums));
  EXPECT_FALSE(same_bits(first, render(*scene, settings(), 1, part, {0, 8}).sums));
  EXPECT_FALSE(same_bits(first, render(*scene, settings(), 0, part, {8, 16}).sums));
}

TEST(Render, TheAovsAskedForDoNotChangeTheColour) {
  const auto scene = prepared(coplanar());
  RenderSettings bare = settings();
  bare.aovs = {Aov::color};
  const auto colors = channels_of(Aov::color);
  const Image a =
      developed(render(*scene, bare, 0, kWhole, {0, 8}).sums, FilmLayout(bare.aovs), colors, Part::all);
  const Image b = developed(render(*scene, settings(), 0, kWhole, {0, 8}).sums, FilmLayout(settings().aovs),
                            colors, Part::all);
  EXPECT_TRUE(same_bits(a, b));
}

TEST(Render, FlushesDenormalsWhateverTheThreadDoesAndLeavesItsModesAlone) {
  const auto scene = prepared(coplanar());
  const unsigned before = _mm_getcsr();
  const Image first = render(*scene, settings(), 0, kWhole, {0, 8}).sums;
  _mm_setcsr(before ^ (_MM_FLUSH_ZERO_ON | _MM_DENORMALS_ZERO_ON | _MM_ROUND_DOWN));
  const unsigned odd = _mm_getcsr();
  const Image second = render(*scene, settings(), 0, kWhole, {0, 8}).sums;
  EXPECT_EQ(_mm_getcsr() & ~0x3fu, odd & ~0x3fu);
  _mm_setcsr(before);
  EXPECT_TRUE(same_bits(first, second));
}

TEST(Render, StopsWhenItIsCancelled) {
  const auto scene = prepared(coplanar());
  const std::atomic<bool> cancel = true;
  EXPECT_THROW(render(*scene, settings(), 0, kWhole, {0, 8}, &cancel), Cancelled);
}

TEST(Render, DropsAndCountsSamplesThatAreNotFinite) {
  Scene scene = coplanar();
  // A lamp too bright for a float: camera rays that see it, and some that gather its light, overflow.
  const int lamp = add_material(scene, {.emission = Color(INFINITY, 1, 1)});
  scene.spheres.push_back({{0, 1, 0}, 0.4f, lamp});
  const auto ready = prepared(scene);
  const Block block = render(*ready, settings(), 0, kWhole, {0, 8});
  const std::uint64_t lost = dropped(block);
  EXPECT_GT(lost, 0u);
  EXPECT_LT(lost, 8u * kFrame.width * kFrame.height);
  for (const float v : block.sums.data()) ASSERT_TRUE(std::isfinite(v));
  EXPECT_EQ(dropped(render(*prepared(coplanar()), settings(), 0, kWhole, {0, 8})), 0u);
}

}  // namespace
}  // namespace tessera
