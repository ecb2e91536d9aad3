// SPDX-License-Identifier: Apache-2.0
// What the choice of a light is worth: the error of direct light under a thousand lamps, at equal samples and
// at equal time, for each LightChoice.
//   light_bench [LAMPS [SAMPLES]]
#include <fmt/format.h>

#include <chrono>
#include <random>

#include "worker/render/render_scene.h"

namespace tessera {
namespace {

using namespace tracer;

// A hall of 60 x 60 m with lamps of three kinds under its ceiling at 4 m, of very different powers, as many
// mesh triangles as anything.
Scene hall(int lamps) {
  Scene scene;
  std::mt19937 engine(7);
  const auto number = [&] { return static_cast<float>(engine() >> 8) * 0x1p-24f; };
  scene.materials.push_back({.emission = Color(5, 5, 5), .double_sided = false});
  Mesh tube{.positions = {{0, 0, 0}, {0, 0, 0.4f}, {0.05f, 0, 0.4f}, {0.05f, 0, 0}}};
  tube.triangles = {{0, 3, 2}, {0, 2, 1}};
  for (Vec3& p : tube.positions) p.z = -p.z;  // front down
  std::swap(tube.triangles[0][0], tube.triangles[0][1]);
  std::swap(tube.triangles[1][0], tube.triangles[1][1]);
  scene.meshes.push_back(tube);
  for (int i = 0; i < lamps; ++i) {
    const Vec3 at(60 * number() - 30, 3.5f + 0.5f * number(), 60 * number() - 30);
    const float power = std::exp(4 * number() - 3);
    if (i % 3 == 0)
      scene.points.push_back({at, Color(power, power, power)});
    else if (i % 3 == 1)
      scene.spots.push_back({at, {0, -1, 0}, Color(power, power, power) * 2.0f, 0.3f, 0.8f});
    else
      scene.instances.push_back({0, Matrix().translate(at)});
  }
  scene.cameras.emplace_back();
  return scene;
}

struct Measured {
  double variance = 0, nanoseconds = 0;  // mean over the floor's points, relative to the squared irradiance
};

Measured measure(const RenderScene& scene, int points, int samples) {
  std::mt19937 engine(11);
  const auto number = [&] { return static_cast<float>(engine() >> 8) * 0x1p-24f; };
  Measured m;
  const Vec3 n(0, 1, 0);
  for (int i = 0; i < points; ++i) {
    const Vec3 p(50 * number() - 25, 0, 50 * number() - 25);
    double sum = 0, squares = 0;
    std::vector<std::array<float, 3>> random(static_cast<std::size_t>(samples));
    for (auto& r : random) r = {number(), number(), number()};
    const auto begin = std::chrono::steady_clock::now();
    for (const auto& [pick, x, y] : random) {
      const LightSample s = scene.lights().sample(p, n, pick, {x, y});
      const double e = s.pdf > 0 ? luminance(s.radiance) * std::max(0.0f, dot(n, s.direction)) / s.pdf : 0;
      sum += e;
      squares += e * e;
    }
    m.nanoseconds +=
        std::chrono::duration<double, std::nano>(std::chrono::steady_clock::now() - begin).count();
    const double mean = sum / samples;
    if (mean > 0) m.variance += (squares / samples - mean * mean) / (mean * mean) / points;
  }
  m.nanoseconds /= static_cast<double>(points) * samples;
  return m;
}

void run(int lamps, int samples) {
  const auto scene = std::make_shared<const Scene>(hall(lamps));
  fmt::print("{} lamps, {} samples at each of 100 points, unshadowed\n", lamps, samples);
  fmt::print("{:<10}{:>14}{:>14}{:>16}{:>16}\n", "choice", "variance", "ns/sample", "worse by",
             "at equal time");
  Measured tree;
  for (const auto& [name, choice] : {std::pair{"tree", LightChoice::tree},
                                     {"power", LightChoice::power},
                                     {"uniform", LightChoice::uniform}}) {
    const RenderScene ready(scene, {}, choice);
    const Measured m = measure(ready, 100, samples);
    if (choice == LightChoice::tree) tree = m;
    fmt::print("{:<10}{:>14.3f}{:>14.1f}{:>16.2f}{:>16.2f}\n", name, m.variance, m.nanoseconds,
               m.variance / tree.variance, m.variance * m.nanoseconds / (tree.variance * tree.nanoseconds));
  }
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  tessera::run(count > 1 ? std::stoi(words[1]) : 1000, count > 2 ? std::stoi(words[2]) : 20000);
  return 0;
}
