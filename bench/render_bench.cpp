// SPDX-License-Identifier: Apache-2.0
// How fast paths are traced, beside what the rays alone cost in the same process.
//   render_bench SCENE [THREADS [SAMPLES [BOUNCES [WIDTHxHEIGHT [SURE_BOUNCES]]]]]
// SURE_BOUNCES as many as BOUNCES: without roulette.
#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <thread>

#include "core/film.h"
#include "core/scene/load.h"
#include "worker/render/camera.h"
#include "worker/render/float_modes.h"
#include "worker/render/render_scene.h"
#include "worker/render/sampler.h"
#include "worker/render/warp.h"

namespace tessera {
namespace {

using namespace tracer;

struct Options {
  std::string scene;
  int threads = 2, samples = 16, bounces = 4, sure = RenderSettings{}.sure_bounces;
  Size size{960, 540};
};

Options parsed(int count, char** words) {
  Options o;
  if (count > 1) o.scene = words[1];
  if (count > 2) o.threads = std::stoi(words[2]);
  if (count > 3) o.samples = std::stoi(words[3]);
  if (count > 4) o.bounces = std::stoi(words[4]);
  if (count > 5) std::sscanf(words[5], "%dx%d", &o.size.width, &o.size.height);
  if (count > 6) o.sure = std::stoi(words[6]);
  return o;
}

// Seconds of wall time, and of processor time summed over the threads (of use where a machine is shared).
struct Spent {
  double wall = 0, processor = 0;
};

double thread_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Runs work(i) for i in [0, count), shared among threads.
template <typename Work>
Spent timed(int threads, std::size_t count, Work work) {
  std::atomic<std::size_t> next = 0;
  std::vector<double> seconds(static_cast<std::size_t>(threads));
  const auto begin = std::chrono::steady_clock::now();
  {
    std::vector<std::jthread> team;
    for (double& mine : seconds)
      team.emplace_back([&] {
        const FlushToZero modes;
        for (std::size_t i; (i = next++) < count;) work(i);
        mine = thread_seconds();
      });
  }
  Spent spent{std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), 0};
  for (const double s : seconds) spent.processor += s;
  return spent;
}

void report(std::string_view what, double count, const Spent& s, int threads) {
  fmt::print("{:<44}{:>9.3f} M/s{:>11.3f} M/s\n", what, count / s.wall * 1e-6,
             count * threads / s.processor * 1e-6);
}

// Packets of rays as a path has them: from the camera, then scattered diffusely where the last ones hit.
class RayBench {
 public:
  RayBench(const RenderScene& scene, const Options& o) : scene_(scene), options_(o) {
    const CameraRays camera(scene.scene(), scene.scene().cameras.front(), o.size, 0, 0);
    for (int y = 0; y < o.size.height; y += 4)
      for (int x = 0; x < o.size.width; x += 4) {
        Packet p;
        for (int lane = 0; lane < kLanes; ++lane) {
          const Ray r = camera.ray(static_cast<float>(x + lane % 4) + 0.5f,
                                   static_cast<float>(y + lane / 4) + 0.5f, {}, 0);
          p.set(lane, r.origin, r.direction, std::numeric_limits<float>::infinity());
        }
        packets_.push_back(p);
      }
  }

  void run(std::string_view what, bool coherent) {
    const Spent s = timed(options_.threads, packets_.size(), [&](std::size_t i) {
      coherent ? scene_.bvh().intersect_coherent(packets_[i]) : scene_.bvh().intersect(packets_[i]);
    });
    report(what, rays(), s, options_.threads);
  }

  // Occlusion rays, cosine distributed, from where the rays hit; then the same rays as the next to trace.
  void scatter(std::string_view what, std::uint32_t bounce) {
    std::vector<ShadowPacket> shadows(packets_.size());
    for (std::size_t i = 0; i < packets_.size(); ++i) scatter(packets_[i], shadows[i], i, bounce);
    const Spent s =
        timed(options_.threads, shadows.size(), [&](std::size_t i) { scene_.bvh().occluded(shadows[i]); });
    report(what, rays(), s, options_.threads);
  }

 private:
  double rays() const {
    double n = 0;
    for (const Packet& p : packets_)
      for (const int active : p.active) n -= active;
    return n;
  }

  void scatter(Packet& p, ShadowPacket& shadow, std::size_t i, std::uint32_t bounce) const {
    for (int lane = 0; lane < kLanes; ++lane) {
      shadow.active[lane] = 0;
      const bool goes_on = p.active[lane] != 0 && p.hit(lane);
      p.active[lane] = 0;
      if (!goes_on) continue;
      const Vec3 from(p.r.ray.org_x[lane], p.r.ray.org_y[lane], p.r.ray.org_z[lane]);
      const Vec3 way(p.r.ray.dir_x[lane], p.r.ray.dir_y[lane], p.r.ray.dir_z[lane]);
      const Surface s = scene_.geometry().surface(p.at(lane), from, way, p.distance(lane));
      const Vec3 n = dot(s.ng, way) > 0 ? -s.ng : s.ng;
      const Vec2 u = random_pair(half_key(1, 0, static_cast<int>(i), lane, 0), 0, bounce);
      const Vec3 d = Frame(n).to_world(cosine_hemisphere(u)), start = offset_origin(s.position, n);
      p.set(lane, start, d, std::numeric_limits<float>::infinity());
      shadow.set(lane, start, d, std::numeric_limits<float>::infinity());
    }
  }

  const RenderScene& scene_;
  const Options& options_;
  std::vector<Packet> packets_;
};

void bench_paths(const RenderScene& scene, const Options& o) {
  const RenderSettings settings{.size = o.size, .max_bounces = o.bounces, .sure_bounces = o.sure};
  const auto cells = grid_cells({0, 0, o.size.width, o.size.height}, {kCellEdge, kCellEdge});
  const Spent s = timed(o.threads, cells.size(), [&](std::size_t i) {
    render(scene, settings, 0, cells[i], {0, o.samples});
  });
  report(fmt::format("pixel samples, {} bounces, {} sure", o.bounces, o.sure),
         double(o.size.width) * o.size.height * o.samples, s, o.threads);
}

int run(const Options& o) {
  if (o.scene.empty() || !std::filesystem::exists(o.scene)) {
    fmt::print("skipped: {}\n", o.scene.empty() ? "no scene file given" : o.scene + " is not there");
    return 0;
  }
  const auto begin = std::chrono::steady_clock::now();
  const auto scene = prepare(std::make_shared<const Scene>(load_scene(o.scene)));
  fmt::print("{}: read and prepared in {:.2f} s; {}x{}, {} samples, {} threads\n", o.scene,
             std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count(), o.size.width,
             o.size.height, o.samples, o.threads);
  fmt::print("{:<44}{:>13}{:>15}\n", "", "by wall", "by processor");
  bench_paths(*scene, o);
  RayBench rays(*scene, o);
  rays.run("Embree, camera rays, packets of 16", true);
  rays.scatter("Embree, occlusion, cosine sky, first hit", 0);
  rays.run("Embree, diffuse bounce 1", false);
  rays.scatter("Embree, occlusion, cosine sky, second hit", 1);
  rays.run("Embree, diffuse bounce 2", false);
  return 0;
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  try {
    return tessera::run(tessera::parsed(count, words));
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 3;
  }
}
