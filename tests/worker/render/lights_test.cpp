// SPDX-License-Identifier: Apache-2.0
// Samples of lights: they follow the densities that hits are weighed with.
#include "worker/render/light/lights.h"

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/scenes.h"
#include "worker/render/render_scene.h"
#include "worker/render/warp.h"

namespace tessera::tracer {
namespace {

using namespace tessera::testing;
using tessera::testing::kPi;

constexpr int kTries = 100000;
const Vec3 kPoint(0.1f, 0.2f, -0.3f);

float escaped(const Lights& lights, const Vec3& direction, float pdf) {
  float sum = 0;
  lights.escaped({kPoint, {0, 1, 0}, pdf}, direction, [&](const Emitted& e) { sum += e.radiance.x; });
  return sum;
}

// Samples of the only light, as points of the unit square; all of them must have the density `pdf`.
void expect_light(const Scene& scene, const std::function<double(const Vec3&)>& pdf, const char* what) {
  const auto ready = prepared(scene);
  Random random(23);
  std::vector<Vec2> points;
  int astray = 0;
  for (int i = 0; i < kTries; ++i) {
    const float pick = random.number();
    const LightSample s = ready->lights().sample(kPoint, Vec3(0, 1, 0), pick, random.pair());
    if (!(s.pdf > 0)) continue;
    ASSERT_NEAR(length(s.direction), 1, 1e-5f);
    const double expected = pdf(s.direction);
    astray += std::abs(s.pdf - expected) > 2e-3 * expected;
    points.push_back(on_square(s.direction));
  }
  // At the edges of a light or of a pixel the directions of floats fall to either side.
  EXPECT_LT(astray, kTries / 1000) << what;
  expect_follows(points, kTries, on_sphere(pdf), what, 40, 40);
}

TEST(Lights, AMeshIsSampledUniformlyByAreaAndWeighedSo) {
  Scene scene;
  const int lamp = add_material(scene, {.emission = Color(1, 1, 1)});
  Mesh quad = grid({-1, 1.5f, 1}, {2, 0, 0}, {0, 0.5f, -2}, 1, lamp);
  add_mesh(scene, quad, Matrix().scale(Vec3(-1, 1, 2)));
  // In the world: corners (+-1, 1.5, 2) and (+-1, 2, -2).
  const Vec3 corner(-1, 1.5f, 2), a(2, 0, 0), b(0, 0.5f, -4);
  const Vec3 normal = unit(cross(a, b));
  const float area = length(cross(a, b));
  const auto pdf = [&](const Vec3& d) -> double {
    const float t = dot(corner - kPoint, normal) / dot(d, normal);
    if (t <= 0) return 0;
    const Vec3 at = kPoint + d * t - corner;
    const float u = dot(at, a) / dot(a, a), v = dot(at, b) / dot(b, b);
    return u >= 0 && u < 1 && v >= 0 && v < 1 ? t * t / (std::abs(dot(d, normal)) * area) : 0;
  };
  expect_light(scene, pdf, "mesh");
}

TEST(Lights, ASphereIsSampledUniformlyByTheSolidAngleSeenFromOutside) {
  Scene scene;
  const int lamp = add_material(scene, {.emission = Color(1, 1, 1)});
  scene.spheres.push_back({{1, 2, 0.5f}, 1.2f, lamp});
  const Vec3 way = scene.spheres[0].center - kPoint;
  const double cosine = std::sqrt(1 - 1.44 / dot(way, way));
  expect_light(
      scene, [&](const Vec3& d) { return dot(d, unit(way)) >= cosine ? 1 / (2 * kPi * (1 - cosine)) : 0; },
      "sphere");
}

TEST(Lights, ASphereIsSampledByAreaFromInside) {
  Scene scene;
  const int lamp = add_material(scene, {.emission = Color(1, 1, 1)});
  scene.spheres.push_back({{0.3f, 0, 0}, 2, lamp});
  const auto pdf = [&](const Vec3& d) {
    const Vec3 way = scene.spheres[0].center - kPoint;
    const double middle = dot(way, d);
    const double half = std::sqrt(4 - (double(dot(way, way)) - middle * middle));
    return (middle + half) * (middle + half) / (half / 2 * 4 * kPi * 4);
  };
  expect_light(scene, pdf, "from inside");
}

TEST(Lights, ASunIsSampledUniformlyInItsDisc) {
  Scene scene;
  const Vec3 way = unit(Vec3(0.2f, -1, 0.4f));
  scene.suns.push_back({way, {1, 1, 1}, 1.0f});
  const double cosine = std::cos(0.5);
  expect_light(
      scene, [&](const Vec3& d) { return -dot(d, way) >= cosine ? 1 / (2 * kPi * (1 - cosine)) : 0; }, "sun");
}

Scene sky(float rotation) {
  Scene scene;
  Picture picture{"sky", 16, 8, 3, std::vector<float>(16 * 8 * 3, 0.02f)};
  Random random(2);
  for (float& v : picture.pixels) v += 3 * square(square(random.number()));
  scene.pictures.push_back(picture);
  scene.environment = {Color(1, 2, 0.5f), 0, rotation};
  return scene;
}

TEST(Lights, APictureIsSampledByTheDensityItStatesWhichIntegratesToOne) {
  const Scene scene = sky(0.7f);
  const EnvironmentLight light(scene);
  expect_light(
      scene, [&](const Vec3& d) { return light.pdf(d); }, "environment");
}

TEST(Lights, ThePictureLiesAroundTheSceneAsDocumented) {
  Scene scene;
  Picture picture{"sky", 64, 32, 3, std::vector<float>(64 * 32 * 3, 0.0f)};
  const auto paint = [&](int x, int y, std::size_t channel) {
    picture.pixels[static_cast<std::size_t>(y * 64 + x) * 3 + channel] = 1;
  };
  for (const int x : {31, 32})
    for (const int y : {15, 16}) paint(x, y, 0);  // the centre
  for (const int x : {47, 48})
    for (const int y : {15, 16}) paint(x, y, 1);  // a quarter to the right
  for (int x = 0; x < 64; ++x) paint(x, 0, 2);    // the top
  scene.pictures.push_back(picture);
  scene.environment = {Color(1, 1, 1), 0, 0};
  const EnvironmentLight plain(scene);
  EXPECT_GT(plain.radiance({0, 0, -1}).x, 0.99f);
  EXPECT_GT(plain.radiance({1, 0, 0}).y, 0.99f);
  EXPECT_GT(plain.radiance({0, 1, 0}).z, 0.99f);
  scene.environment.rotation = kPi / 2;  // counter-clockwise seen from above: -Z goes to -X
  const EnvironmentLight turned(scene);
  EXPECT_GT(turned.radiance({-1, 0, 0}).x, 0.99f);
  EXPECT_GT(turned.radiance({0, 0, -1}).y, 0.99f);
}

// Steradians of a triangle seen from the origin; van Oosterom and Strackee 1983.
double solid_angle(const Imath::V3d& a, const Imath::V3d& b, const Imath::V3d& c) {
  const double la = a.length(), lb = b.length(), lc = c.length();
  return std::abs(
      2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + a.dot(c) * lb + b.dot(c) * la));
}

// Where a direction from kPoint meets a quad: false if nowhere.
bool meets(const Quad& q, const Vec3& d, double& distance, double& cosine) {
  const Imath::V3d eu(q.edge_u), ev(q.edge_v), n = eu.cross(ev), dir(d), to(q.corner - kPoint);
  distance = to.dot(n) / dir.dot(n);
  cosine = std::abs(dir.dot(n)) / n.length();
  if (!(distance > 0)) return false;
  const Imath::V3d at = dir * distance - to;
  const double u = at.cross(ev).dot(n) / n.dot(n), v = eu.cross(at).dot(n) / n.dot(n);
  return u >= 0 && u < 1 && v >= 0 && v < 1;
}

TEST(Lights, ARectangleIsSampledUniformlyByTheSolidAngleSeen) {
  // Beside the point, and over it so near that it fills half of the sky.
  for (const Quad& quad : {Quad{{-1, 1.5f, 1}, {2, 0.5f, 0}, {0.5f, -2, -2}, 0},
                           Quad{{-2, 0.5f, -2}, {4, 0, 0}, {0, 0, 3}, 0}}) {
    Scene scene;
    add_material(scene, {.emission = Color(1, 1, 1)});
    Quad q = quad;
    q.edge_v = q.edge_v - q.edge_u * (dot(q.edge_v, q.edge_u) / dot(q.edge_u, q.edge_u));
    scene.quads.push_back(q);
    const Imath::V3d a(q.corner - kPoint), u(q.edge_u), v(q.edge_v);
    const double whole = solid_angle(a, a + u, a + u + v) + solid_angle(a, a + u + v, a + v);
    double distance, cosine;
    expect_light(
        scene, [&](const Vec3& d) { return meets(q, d, distance, cosine) ? 1 / whole : 0; }, "rectangle");
  }
}

TEST(Lights, AParallelogramIsSampledUniformlyByArea) {
  Scene scene;
  add_material(scene, {.emission = Color(1, 1, 1)});
  const Quad q{{-1, 1, 1}, {2, 0.5f, 0}, {1, 0.5f, -2}, 0};
  scene.quads.push_back(q);
  const double area = length(cross(q.edge_u, q.edge_v));
  double distance, cosine;
  expect_light(
      scene,
      [&](const Vec3& d) {
        return meets(q, d, distance, cosine) ? distance * distance / (cosine * area) : 0;
      },
      "parallelogram");
}

TEST(Lights, ADiskIsSampledUniformlyByArea) {
  Scene scene;
  add_material(scene, {.emission = Color(1, 1, 1)});
  const Disk disk{{0.5f, 1, -1}, unit(Vec3(0.3f, -1, 0.2f)), 0.8f, 0};
  scene.disks.push_back(disk);
  const auto pdf = [&](const Vec3& d) -> double {
    const double t = dot(disk.center - kPoint, disk.normal) / dot(d, disk.normal);
    if (t <= 0) return 0;
    const Vec3 at = kPoint + d * float(t) - disk.center;
    return dot(at, at) < 0.64 ? t * t / (std::abs(dot(d, disk.normal)) * kPi * 0.64) : 0;
  };
  expect_light(scene, pdf, "disk");
}

TEST(Lights, PowerAndNothingButTheNumberPickIfToldSo) {
  Scene scene;
  scene.points.push_back({{0, 1, 0}, {3, 3, 3}});
  scene.points.push_back({{0, -1, 0}, {1, 1, 1}});
  scene.points.push_back({{1, 0, 0}, {0, 0, 0}});
  const auto shared = std::make_shared<const Scene>(scene);
  const auto pdf = [&](LightChoice choice, const Vec3& p, float pick) {
    return RenderScene(shared, {}, choice).lights().sample(p, {0, 1, 0}, pick, {}).pdf;
  };
  EXPECT_FLOAT_EQ(pdf(LightChoice::power, {0, 0.9f, 0}, 0.5f), 0.75f);
  EXPECT_FLOAT_EQ(pdf(LightChoice::power, {0, 0.9f, 0}, 0.8f), 0.25f);
  for (const float pick : {0.2f, 0.7f}) EXPECT_FLOAT_EQ(pdf(LightChoice::uniform, {0, 0.9f, 0}, pick), 0.5f);
  EXPECT_FLOAT_EQ(pdf(LightChoice::tree, {0, 0.9f, 0}, 0.5f), 0.75f);  // but two: by power
  // The tree heeds the distance: 3 / 0.1^2 against (1 + 1) / 1.9^2.
  scene.points.push_back(scene.points[1]);
  const RenderScene three(std::make_shared<const Scene>(scene));
  EXPECT_FLOAT_EQ(three.lights().sample({0, 0.9f, 0}, {0, 1, 0}, 0.5f, {}).pdf, 300 / (300 + 2 / 3.61f));
}

// The integral over all directions of what a glossy point reflects, by either strategy alone and by both.
TEST(Lights, EitherStrategyAloneAndBothTogetherAgree) {
  const Scene scene = sky(0);
  const auto ready = prepared(scene);
  const Lights& lights = ready->lights();
  Bsdf b{.frame = Frame(Vec3(0, 1, 0)), .ng = {0, 1, 0}};
  const Color f0(0.3f, 0.3f, 0.3f);
  b.lobes.add({.kind = Lobe::Kind::reflection,
               .fresnel = Lobe::Fresnel::schlick,
               .alpha = 0.2f,
               .color = Color(1, 1, 1),
               .f0 = f0});
  b.lobes.add({.kind = Lobe::Kind::coated, .color = Color(0.5f, 0.5f, 0.5f), .f0 = f0});
  b.wo = unit(Vec3(0.5f, 0.2f, 0.8f));
  balance(b);
  Random random(31);
  constexpr int kMany = 200000;
  struct Sum {
    double sum = 0, squares = 0;
    void add(double v) { sum += v, squares += v * v; }
    double mean() const { return sum / kMany; }
    double error() const { return std::sqrt((squares / kMany - mean() * mean()) / kMany); }
  } by_light, by_surface, by_both;
  for (int i = 0; i < kMany; ++i) {
    const LightSample l = lights.sample(kPoint, Vec3(0, 1, 0), random.number(), random.pair());
    const BsdfValue v = evaluate(b, l.direction);
    const double direct = l.pdf > 0 ? v.f().x * l.radiance.x / l.pdf : 0;
    const float lobe = random.number();
    const BsdfSample s = sample(b, lobe, random.pair());
    const double found = s.pdf > 0 ? s.weight().x * escaped(lights, s.wi, 0) : 0;
    const double weighed = s.pdf > 0 ? s.weight().x * escaped(lights, s.wi, s.pdf) : 0;
    by_light.add(direct);
    by_surface.add(found);
    by_both.add(direct * (l.pdf > 0 ? power_heuristic(l.pdf, v.pdf) : 0) + weighed);
  }
  EXPECT_NEAR(by_both.mean(), by_light.mean(), 5 * std::hypot(by_both.error(), by_light.error()));
  EXPECT_NEAR(by_both.mean(), by_surface.mean(), 5 * std::hypot(by_both.error(), by_surface.error()));
  EXPECT_LT(by_both.error(), std::max(by_light.error(), by_surface.error()));
}

}  // namespace
}  // namespace tessera::tracer
