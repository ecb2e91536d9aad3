// SPDX-License-Identifier: Apache-2.0
// How large a scene may be: seconds and memory of a mesh that stands in a million places, and of a mesh of
// ten million triangles.
//   instances_bench [INSTANCES [TRIANGLES]]
#include <fmt/format.h>

#include <array>
#include <chrono>
#include <fstream>
#include <string>

#include "core/film.h"
#include "worker/render/render_scene.h"

namespace tessera {
namespace {

using namespace tracer;
using Clock = std::chrono::steady_clock;

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// Bytes that this process holds now, and the most that it held since the last reset.
struct Resident {
  double now = 0, peak = 0;
};
Resident resident() {
  Resident r;
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);) {
    if (line.starts_with("VmRSS:")) r.now = std::stod(line.substr(6)) * 1024;
    if (line.starts_with("VmHWM:")) r.peak = std::stod(line.substr(6)) * 1024;
  }
  return r;
}
void reset_peak() { std::ofstream("/proc/self/clear_refs") << "5"; }

// A wavy sheet of about so many triangles.
Mesh sheet(int triangles) {
  Mesh mesh;
  const int n = std::max(1, static_cast<int>(std::sqrt(triangles / 2.0)));
  const auto steps = static_cast<float>(n);
  for (int j = 0; j <= n; ++j)
    for (int i = 0; i <= n; ++i) {
      const float x = static_cast<float>(i) / steps, z = static_cast<float>(j) / steps;
      mesh.positions.emplace_back(x, 0.2f * std::sin(9 * x) * std::cos(7 * z), z);
    }
  const auto at = [n](int i, int j) { return static_cast<std::uint32_t>(j * (n + 1) + i); };
  for (int j = 0; j < n; ++j)
    for (int i = 0; i < n; ++i) {
      mesh.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i + 1, j)});
      mesh.triangles.push_back({at(i, j), at(i, j + 1), at(i + 1, j + 1)});
    }
  return mesh;
}

// So many of them, each turned its own way, on a square grid seen from above one corner.
Scene field(int instances, int triangles) {
  Scene scene;
  scene.materials.emplace_back();
  scene.meshes.push_back(sheet(triangles));
  const int edge = static_cast<int>(std::ceil(std::sqrt(instances)));
  scene.instances.reserve(static_cast<std::size_t>(instances));
  for (int i = 0; i < instances; ++i) {
    Matrix turn;
    turn.setAxisAngle(Vec3(0, 1, 0), static_cast<float>(i));
    scene.instances.push_back(
        {0, turn * Matrix().translate(Vec3(float(i % edge), 0, float(i / edge)) * 1.2f)});
  }
  scene.environment.radiance = Color(1, 1, 1);
  Camera camera;
  Matrix down;
  down.setAxisAngle(Vec3(1, 0, 0), -0.4f);
  Matrix aside;
  aside.setAxisAngle(Vec3(0, 1, 0), -2.36f);
  camera.to_world = down * aside * Matrix().translate(Vec3(-3, 0.02f * float(edge) + 2, -3));
  scene.cameras.push_back(camera);
  return scene;
}

void run(const char* what, int instances, int triangles) {
  reset_peak();
  const double before = resident().now;
  const auto begin = Clock::now();
  auto scene = std::make_shared<Scene>(field(instances, triangles));
  const double made = seconds_since(begin), held = resident().now;
  const auto building = Clock::now();
  const auto ready = prepare(std::move(scene));
  const double built = seconds_since(building);
  const Resident after = resident();
  const auto rendering = Clock::now();
  const RenderSettings settings{.size = {320, 180}, .max_bounces = 2};
  const Block block = render(*ready, settings, 0, {0, 0, 320, 180}, {0, 4});
  fmt::print("{:<40}{:>9.2f}{:>9.2f}{:>9.2f}{:>12.0f}{:>12.0f}{:>12.0f}\n", what, made, built,
             seconds_since(rendering), (held - before) / 1e6, (after.now - held) / 1e6,
             resident().peak / 1e6);
  if (dropped(block) > 0) fmt::print("  {} samples were not finite\n", dropped(block));
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  const int instances = count > 1 ? std::stoi(words[1]) : 1'000'000;
  const int triangles = count > 2 ? std::stoi(words[2]) : 10'000'000;
  fmt::print("{:<40}{:>9}{:>9}{:>9}{:>12}{:>12}{:>12}\n", "", "make s", "build s", "render s", "scene MB",
             "tables MB", "peak MB");
  tessera::run(fmt::format("{} instances of 10000 triangles", instances).c_str(), instances, 10000);
  tessera::run(fmt::format("one mesh of {} triangles", triangles).c_str(), 1, triangles);
  return 0;
}
