// SPDX-License-Identifier: Apache-2.0
// Irradiance at a point where it is known in closed form, found by sampling lights alone, by hits alone, and
// by both weighed together, without the integrator. All to four standard errors.
#include <gtest/gtest.h>

#include <set>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/one_ray.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using Imath::V3d;
using tessera::testing::kPi;

const Vec3 kAt(0.2f, -0.1f, 0.3f);
constexpr int kMany = 40000;

struct Mean {
  double sum = 0, squares = 0;
  void add(double v) { sum += v, squares += v * v; }
  double mean() const { return sum / kMany; }
  double error() const { return std::sqrt(std::max(0.0, squares / kMany - mean() * mean()) / kMany); }
};
struct Irradiance {
  Mean by_light, by_hit, by_both;
};

double total(const RenderScene& scene, const Vertex& from, const Vec3& d, float time) {
  double sum = 0;
  const auto seen = look(scene, from.position, d, {.time = time, .kind = RayKind::scattered});
  if (!seen)
    scene.lights().escaped(from, d, [&](const Emitted& e) { sum += e.radiance.x; });
  else if (seen->surface.light >= 0)
    sum = scene.lights().hit(from, d, seen->surface).radiance.x;
  return sum;
}

Irradiance measured(const RenderScene& scene, const Vec3& n, const Vec3& at = kAt) {
  Random random(53);
  Irradiance e;
  for (int i = 0; i < kMany; ++i) {
    const float time = random.number(), pick = random.number();
    const LightSample l = scene.lights().sample(at, n, pick, random.pair(), time);
    const float cosine = l.pdf > 0 ? dot(n, l.direction) : 0;
    double light = 0, weight = 1;
    if (cosine > 0) {
      const bool hidden = l.infinite ? blocked(scene, at, l.direction, kEndless, {time, RayKind::shadow})
                                     : blocked(scene, at, l.target - at, 1, {time, RayKind::shadow});
      light = hidden ? 0 : l.radiance.x * cosine / l.pdf;
      if (!l.delta) weight = power_heuristic(l.pdf, cosine * kInvPi);
    }
    e.by_light.add(light);
    const Vec3 local = cosine_hemisphere(random.pair()), d = Frame(n).to_world(local);
    e.by_hit.add(kPi * total(scene, {at, n, 0}, d, time));
    e.by_both.add(light * weight +
                  (local.z > 0 ? kPi * total(scene, {at, n, local.z * kInvPi}, d, time) : 0));
  }
  return e;
}

void expect_all(const Scene& scene, const Vec3& n, double expected, const char* what, const Vec3& at = kAt,
                double slack = 1e-5) {
  const Irradiance e = measured(RenderScene(std::make_shared<const Scene>(scene), {0, 1}), n, at);
  EXPECT_NEAR(e.by_light.mean(), expected, 4 * e.by_light.error() + slack * expected) << what << ", lights";
  EXPECT_NEAR(e.by_hit.mean(), expected, 4 * e.by_hit.error() + slack * expected) << what << ", hits";
  EXPECT_NEAR(e.by_both.mean(), expected, 4 * e.by_both.error() + slack * expected) << what << ", both";
}

// What only sampling finds.
void expect_sampled(const Scene& scene, const Vec3& n, double expected, const char* what) {
  const Irradiance e = measured(*prepared(scene), n);
  EXPECT_NEAR(e.by_light.mean(), expected, 4 * e.by_light.error() + 1e-5 * expected) << what;
  EXPECT_NEAR(e.by_both.mean(), expected, 4 * e.by_both.error() + 1e-5 * expected) << what;
  EXPECT_EQ(e.by_hit.mean(), 0) << what;
}

Scene with_lamp(bool double_sided = false) {
  Scene scene;
  add_material(scene, {.emission = Color(2, 2, 2), .double_sided = double_sided});
  return scene;
}

// Irradiance by a polygon of radiance 2 that is all above the horizon; Lambert 1760, as in Arvo 1995,
// "Applications of Irradiance Tensors to the Simulation of Non-Lambertian Phenomena", section 3.
double polygon(const std::vector<V3d>& corners, const Vec3& n, const Vec3& at = kAt) {
  double sum = 0;
  for (std::size_t i = 0; i < corners.size(); ++i) {
    const V3d a = (corners[i] - V3d(at)).normalized(),
              b = (corners[(i + 1) % corners.size()] - V3d(at)).normalized();
    sum += std::acos(a.dot(b)) * a.cross(b).normalized().dot(V3d(n));
  }
  return std::abs(sum);  // 2 / 2 times
}
double polygon(const Quad& q, const Vec3& n) {
  const V3d c(q.corner), u(q.edge_u), v(q.edge_v);
  return polygon({c, c + u, c + u + v, c + v}, n);
}

const Quad kRectangle{{-1, 2, -0.5f}, {2.5f, 0, 0}, {0, 0.5f, 2}};  // front down
const Quad kParallelogram{{-1, 2, -0.5f}, {2.5f, 0.4f, 0.6f}, {0, 0.5f, 2}};

TEST(Irradiance, OfQuads) {
  for (const Quad& quad : {kRectangle, kParallelogram, Quad{{-3, 0.2f, -3}, {6, 0, 0}, {0, 0, 6}},
                           Quad{{30, 100, 20}, {0.1f, 0, 0}, {0, 0, 0.2f}}}) {
    Scene scene = with_lamp();
    scene.quads.push_back(quad);
    const Vec3 n = unit(Vec3(0.05f, 1, 0.05f));
    const Irradiance e = measured(*prepared(scene), n);
    const double known = polygon(quad, n);
    EXPECT_NEAR(e.by_light.mean(), known, 4 * e.by_light.error() + 1e-4 * known);
    EXPECT_NEAR(e.by_both.mean(), known, 4 * e.by_both.error() + 1e-4 * known);
    EXPECT_NEAR(e.by_hit.mean(), known, 4 * e.by_hit.error() + 2e-5);
  }
}

TEST(Irradiance, OfTheTrianglesOfAMesh) {
  Scene scene = with_lamp();
  add_mesh(scene, grid(kParallelogram.corner, kParallelogram.edge_u, kParallelogram.edge_v, 3, 0),
           Matrix().scale(Vec3(1, 1, 1)) * Matrix().translate(Vec3(0, 1, 0)));
  Quad higher = kParallelogram;
  higher.corner.y += 1;
  expect_all(scene, {0, 1, 0}, polygon(higher, {0, 1, 0}), "mesh");
}

TEST(Irradiance, OfAMeshOfMoreTrianglesThanAreLightsOfTheirOwn) {
  Scene scene = with_lamp();
  Mesh fine = grid(kParallelogram.corner, kParallelogram.edge_u, kParallelogram.edge_v, 730, 0);
  for (Vec3& p : fine.positions) p.x = -1 + (p.x + 1) * (p.x + 1) / 2.5f;  // uneven ones
  const auto stretched = [](const Vec3& p) { return Vec3(p.x, 0.5f * p.y + 1, 1.5f * p.z); };
  add_mesh(scene, std::move(fine), Matrix().scale(Vec3(1, 0.5f, 1.5f)) * Matrix().translate(Vec3(0, 1, 0)));
  ASSERT_GT(scene.meshes[0].triangles.size(), std::size_t{1} << 20);
  const Quad small{{2, 2, 0}, {1, 0, 0}, {0, 0, 1}};
  for (int i = 0; i < 2; ++i)  // more than two lights: the tree picks
    add_mesh(scene, grid(small.corner + small.edge_u * float(i), small.edge_u, small.edge_v, 1, 0));
  // The rim of the sheet as it was bent, in short straight pieces.
  std::vector<V3d> rim;
  constexpr int kPieces = 730;
  const auto along = [&](float u, float v) {
    Vec3 p = kParallelogram.corner + kParallelogram.edge_u * u + kParallelogram.edge_v * v;
    p.x = -1 + (p.x + 1) * (p.x + 1) / 2.5f;
    rim.emplace_back(stretched(p));
  };
  for (int i = 0; i < kPieces; ++i) along(float(i) / kPieces, 0);
  along(1, 0);
  for (int i = 0; i <= kPieces; ++i) along(1 - float(i) / kPieces, 1);
  const double known = polygon(rim, {0, 1, 0}) + polygon(small, {0, 1, 0}) +
                       polygon(Quad{{3, 2, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 0});
  expect_all(scene, {0, 1, 0}, known, "fine mesh", kAt, 1e-3);
}

// Disk parallel to the surface, its centre `a` to the side and `h` above; Howell, A Catalog of Radiation
// Configuration Factors, B-13.
double disk_factor(double r, double h, double a) {
  const double z = a * a + h * h + r * r;
  return 0.5 * (1 - (a * a + h * h - r * r) / std::sqrt(z * z - 4 * a * a * r * r));
}

TEST(Irradiance, OfDisksAboveAndToTheSide) {
  for (const float aside : {0.0f, 0.7f, 4.0f})
    for (const float radius : {0.2f, 1.5f}) {
      Scene scene = with_lamp();
      scene.disks.push_back({kAt + Vec3(aside, 1.2f, 0), {0, -1, 0}, radius});
      expect_all(scene, {0, 1, 0}, 2 * kPi * disk_factor(radius, 1.2f, aside), "disk", kAt, 1e-4);
    }
}

TEST(Irradiance, OfSpheresFromOutsideAndFromInside) {
  Scene scene = with_lamp();
  scene.spheres.push_back({kAt + Vec3(1, 2, 0), 0.8f});
  expect_all(scene, {0, 1, 0}, 2 * kPi * 0.64 / 5 * (2 / std::sqrt(5)), "outside", kAt, 1e-4);
  Scene inside = with_lamp(true);
  inside.spheres.push_back({kAt + Vec3(0.5f, 0.2f, 0), 2});
  expect_all(inside, {0, 1, 0}, 2 * kPi, "inside");
}

TEST(Irradiance, OfPointsSpotsAndSuns) {
  Scene point, spot, sun, disc, sky;
  point.points.push_back({kAt + Vec3(1, 2, 0), {5, 5, 5}});
  expect_sampled(point, {0, 1, 0}, 5 * 2 / std::pow(5, 1.5), "point");
  spot.spots.push_back({kAt + Vec3(1, 2, 0), -unit(Vec3(1, 2, 0)), {5, 5, 5}, 0.1f, 0.3f});
  expect_sampled(spot, {0, 1, 0}, 5 * 2 / std::pow(5, 1.5), "spot");
  sun.suns.push_back({unit(Vec3(0.6f, -0.8f, 0)), {3, 3, 3}});
  expect_sampled(sun, {0, 1, 0}, 2.4, "sun without extent");
  disc.suns.push_back({unit(Vec3(0.6f, -0.8f, 0)), {3, 3, 3}, 0.8f});
  expect_all(disc, {0, 1, 0}, 2.4, "sun with a disc");
}

TEST(Irradiance, OfTheBackOfASingleSidedLightIsNone) {
  for (const bool double_sided : {false, true}) {
    Scene scene = with_lamp(double_sided);
    Quad quad = kRectangle;
    quad.edge_u = -quad.edge_u;
    scene.quads.push_back(quad);
    scene.disks.push_back({kAt + Vec3(4, 1, 0), {0, 1, 0}, 0.5f});
    const double known = polygon(quad, {0, 1, 0}) + 2 * kPi * disk_factor(0.5, 1, 4);
    expect_all(scene, {0, 1, 0}, double_sided ? known : 0, "back", kAt, 1e-4);
  }
}

// Sampling finds lights behind the surface as well: light may come through it.
TEST(Irradiance, FromBelowIsSampledToo) {
  Scene scene = with_lamp();
  scene.quads.push_back(kRectangle);
  const auto ready = prepared(scene);
  int found = 0;
  for (int i = 0; i < 100; ++i)
    found += ready->lights().sample(kAt, {0, -1, 0}, 0.5f, {float(i) / 100, 0.5f}).pdf > 0;
  EXPECT_EQ(found, 100);
}

TEST(Irradiance, OfAMovingLightIsTheMeanOverTheShutter) {
  Scene scene = with_lamp();
  Matrix turn;
  turn.setAxisAngle(Vec3(0, 0, 1), 0.6f);
  const Matrix end = Matrix().scale(Vec3(0.5f, 1, 2)) * turn * Matrix().translate(Vec3(0.5f, 1, 0));
  scene.tracks.push_back({{0, 1}, {Matrix(), end}});
  scene.objects.push_back({.track = 0});
  add_mesh(scene, grid(kRectangle.corner, kRectangle.edge_u, kRectangle.edge_v, 2, 0));
  scene.instances[0].object = 0;
  scene.quads.push_back({{-3, 3, -1}, {0.5f, 0, 0}, {0, 0, 0.5f}});  // a second light, which rests
  const Geometry geometry(scene, {0, 1});
  double known = 0;
  constexpr int kTimes = 400;
  for (int i = 0; i < kTimes; ++i) {
    const Matrix m = geometry.to_world(0, (float(i) + 0.5f) / kTimes);
    std::vector<V3d> corners;
    for (const Vec3& p :
         {kRectangle.corner, kRectangle.corner + kRectangle.edge_u,
          kRectangle.corner + kRectangle.edge_u + kRectangle.edge_v, kRectangle.corner + kRectangle.edge_v})
      corners.emplace_back(moved(p, m));
    known += polygon(corners, {0, 1, 0}) / kTimes;
  }
  expect_all(scene, {0, 1, 0}, known + polygon(scene.quads[0], {0, 1, 0}), "moving", kAt, 1e-4);
}

TEST(Irradiance, ALightThatTheCameraDoesNotSeeLightsAllTheSame) {
  Scene scene = with_lamp();
  scene.objects = {{.camera = false}};
  scene.quads.push_back(kRectangle);
  scene.quads[0].object = 0;
  EXPECT_FALSE(look(*prepared(scene), kAt, {0, 1, 0}, {.kind = RayKind::camera}));
  EXPECT_TRUE(look(*prepared(scene), kAt, {0, 1, 0}, {.kind = RayKind::scattered}));
  expect_all(scene, {0, 1, 0}, polygon(kRectangle, {0, 1, 0}), "not seen by the camera");
}

TEST(Irradiance, ALightThatNobodySeesLightsAllTheSame) {
  Scene scene = with_lamp();
  scene.objects = {{.camera = false, .scattered = false, .shadow = false}};
  scene.quads.push_back({{-3, 3, -1}, {0.5f, 0, 0}, {0, 0, 0.5f}});
  scene.quads.push_back(kRectangle);
  scene.quads[0].object = scene.quads[1].object = 0;
  scene.disks.push_back({kAt + Vec3(0, 4, 0), {0, -1, 0}, 0.5f, 0, 0});  // above the rectangle
  expect_sampled(
      scene, {0, 1, 0},
      polygon(kRectangle, {0, 1, 0}) + polygon(scene.quads[0], {0, 1, 0}) + 2 * kPi * disk_factor(0.5, 4, 0),
      "not seen at all");
}

TEST(Irradiance, ALightThatScatteredRaysDoNotSeeIsSampledWithoutAWeight) {
  Scene scene = with_lamp();
  scene.objects = {{.scattered = false}, {}};
  scene.quads.push_back(kRectangle);
  scene.spheres.push_back({kAt + Vec3(-3, 2, 0), 0.5f});
  add_mesh(scene, grid({2, 2, 0}, {1, 0, 0}, {0, 0, 1}, 1, 0));
  scene.quads[0].object = scene.spheres[0].object = scene.instances[0].object = 0;
  const double known = polygon(kRectangle, {0, 1, 0}) + 2 * kPi * 0.25 / 13 * (2 / std::sqrt(13)) +
                       polygon(Quad{{2, 2, 0}, {1, 0, 0}, {0, 0, 1}}, {0, 1, 0});
  expect_sampled(scene, {0, 1, 0}, known, "not seen by scattered rays");
}

TEST(Irradiance, ALightThatCastsNoShadowLetsOthersThrough) {
  Scene scene = with_lamp();
  scene.objects = {{.shadow = false}};
  scene.quads.push_back(kRectangle);
  scene.points.push_back({kAt + Vec3(0, 4, 0), {16, 16, 16}});
  const double lamp = polygon(kRectangle, {0, 1, 0});
  const auto by_light = [&] { return measured(*prepared(scene), {0, 1, 0}).by_light; };
  const Mean in_shadow = by_light();
  EXPECT_NEAR(in_shadow.mean(), lamp, 4 * in_shadow.error());
  scene.quads[0].object = 0;
  const Mean through = by_light();
  EXPECT_NEAR(through.mean(), lamp + 1, 4 * through.error());
}

// Each light of its own group, asked for by what a sample and a hit say.
TEST(Irradiance, KnowsWhoseLightItIs) {
  Scene scene = with_lamp();
  for (int i = 0; i < 4; ++i) scene.objects.push_back({.light = {.group = i}});
  scene.quads.push_back({{-2, 2, -0.5f}, {1, 0, 0}, {0, 0, 1}, 0, 0});
  scene.disks.push_back({{2, 2, 0}, {0, -1, 0}, 0.5f, 0, 1});
  scene.spheres.push_back({{0, 2, 3}, 0.5f, 0, 2});
  add_mesh(scene, grid({0, 2, -3}, {1, 0, 0}, {0, 0, 1}, 2, 0));
  scene.instances[0].object = 3;
  scene.points.push_back({{5, 2, 0}, {1, 1, 1}, {.group = 4}});
  scene.spots.push_back({{-5, 2, 0}, {0, -1, 0}, {1, 1, 1}, 0.5f, 1.5f, {.group = 5}});
  scene.suns.push_back({unit(Vec3(-0.3f, -1, 0.1f)), {1, 1, 1}, 0.1f, true, {.group = 6}});
  scene.environment.radiance = Color(1, 1, 1);
  scene.environment.light.group = 7;
  const auto ready = prepared(scene);
  const Lights& lights = ready->lights();
  Random random(59);
  std::set<int> sampled;
  for (int i = 0; i < 4000; ++i) {
    const float pick = random.number();
    const LightSample l = lights.sample(kAt, {0, 1, 0}, pick, random.pair());
    if (!(l.pdf > 0)) continue;
    sampled.insert(l.traits->group);
    if (l.delta) continue;
    const auto seen = look(*ready, kAt, l.direction, {.kind = RayKind::scattered});
    if (!l.infinite && seen && seen->surface.light >= 0) {
      EXPECT_EQ(lights.hit({kAt, {0, 1, 0}, 1}, l.direction, seen->surface).traits->group, l.traits->group);
    }
  }
  EXPECT_EQ(sampled, (std::set<int>{0, 1, 2, 3, 4, 5, 6}));
  std::set<int> around;
  lights.escaped({kAt, {0, 1, 0}, 1}, unit(Vec3(0.3f, 1, -0.1f)),
                 [&](const Emitted& e) { around.insert(e.traits->group); });
  EXPECT_EQ(around, (std::set<int>{6, 7}));
}

// Lamps of all kinds about a point, some of them hidden behind a wall.
Scene many_lamps() {
  Scene scene = with_lamp();
  add_material(scene, {});
  Random random(61);
  const auto place = [&] {
    return Vec3(8 * random.number() - 4, 1 + 2 * random.number(), 8 * random.number() - 4);
  };
  for (int i = 0; i < 25; ++i) {
    scene.points.push_back({place(), Color(1, 1, 1) * random.number()});
    scene.spots.push_back({place(), unit(Vec3(random.number() - 0.5f, -1, 0)), {2, 2, 2}, 0.3f, 0.9f});
    scene.spheres.push_back({place(), 0.2f * random.number()});
    scene.quads.push_back({place(), {0.3f, 0, 0}, {0, 0.1f, 0.3f * random.number()}});
    scene.disks.push_back({place(), unit(Vec3(random.number() - 0.5f, -1, 0)), 0.2f});
  }
  add_mesh(scene, grid({-2, 2, -2}, {1, 0, 0}, {0, 0, 1}, 4, 0));
  add_mesh(scene, grid({1, 0, -4}, {0, 3, 0}, {0, 0, 8}, 1, 1));
  scene.suns.push_back({unit(Vec3(-0.3f, -1, 0.1f)), {1, 1, 1}, 0.2f});
  return scene;
}

TEST(Irradiance, IsTheSameHoweverLightsArePickedAndTheTreeIsTheSurest) {
  const auto scene = std::make_shared<const Scene>(many_lamps());
  const RenderScene tree(scene), power(scene, {}, LightChoice::power),
      uniform(scene, {}, LightChoice::uniform);
  const Vec3 n = unit(Vec3(0.2f, 1, 0.1f));
  const Irradiance a = measured(tree, n), b = measured(power, n), c = measured(uniform, n);
  for (const Irradiance* other : {&b, &c}) {
    EXPECT_NEAR(a.by_light.mean(), other->by_light.mean(),
                4 * std::hypot(a.by_light.error(), other->by_light.error()));
    EXPECT_NEAR(a.by_both.mean(), other->by_both.mean(),
                4 * std::hypot(a.by_both.error(), other->by_both.error()));
    EXPECT_LT(a.by_light.error(), other->by_light.error());
  }
  EXPECT_NEAR(a.by_both.mean(), a.by_light.mean(), 4 * std::hypot(a.by_both.error(), a.by_light.error()));
}

}  // namespace
}  // namespace tessera::tracer
