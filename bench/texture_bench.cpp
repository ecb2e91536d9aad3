// SPDX-License-Identifier: Apache-2.0
// What a texture lookup costs, and what memory a scene of many textures takes under a limit.
//   texture_bench [PICTURES [EDGE [LIMIT_MIB [FOLDER]]]]
// The pictures, the scene that shows them (scene.json, also of use to render_bench) and the converted files
// stay in FOLDER if one is given.
#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "core/png.h"
#include "core/scene/load.h"
#include "core/scene/pictures.h"
#include "worker/render/float_modes.h"
#include "worker/render/render.h"
#include "worker/render/texture.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using namespace tracer;
using Clock = std::chrono::steady_clock;

struct Options {
  int pictures = 16, edge = 2048;
  std::uint64_t limit = 64;  // MiB
  fs::path folder;
};

double seconds_since(Clock::time_point begin) {
  return std::chrono::duration<double>(Clock::now() - begin).count();
}

// A field of /proc/self/status in MiB: VmRSS is what the process holds now, VmHWM the most it ever held.
double status_mib(const std::string& field) {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with(field + ":")) return std::stod(line.substr(field.size() + 1)) / 1024;
  return 0;
}

// Steps of a linear congruential generator (Numerical Recipes, section 7.1): cheap beside a lookup.
struct Steps {
  std::uint32_t state = 1;
  float next() {
    state = state * 1664525u + 1013904223u;
    return static_cast<float>(state >> 8) * 0x1p-24f;
  }
};

Image noise(int edge, std::uint32_t seed) {
  Image image({0, 0, edge, edge}, 3);
  Steps steps{seed};
  for (int p = 0; p < 3; ++p)
    for (float& v : image.plane(p)) v = 0.2f + 0.1f * static_cast<float>(p) + 0.1f * steps.next();
  return image;
}

// A wall of squares, each with a picture of its own, filling the frame.
void write_scene(const Options& o) {
  const int columns = static_cast<int>(std::ceil(std::sqrt(o.pictures)));
  std::string materials, meshes;
  for (int i = 0; i < o.pictures; ++i) {
    const fs::path file = o.folder / fmt::format("{}.png", i);
    if (!fs::exists(file)) write_png(file, noise(o.edge, static_cast<std::uint32_t>(i + 1)));
    const int x = i % columns, y = i / columns;
    const char* comma = i ? ",\n" : "";
    materials += fmt::format("{}\"m{}\": {{\"color_texture\": \"{}.png\"}}", comma, i, i);
    meshes += fmt::format(
        "{}\"q{}\": {{\"material\": \"m{}\", \"positions\": [[{},{},0],[{},{},0],[{},{},0],[{},{},0]], "
        "\"uvs\": [[0,1],[1,1],[1,0],[0,0]], \"quads\": [[0,1,2,3]]}}",
        comma, i, i, x, y, x + 1, y, x + 1, y + 1, x, y + 1);
  }
  const double middle = columns / 2.0;
  std::ofstream(o.folder / "scene.json") << fmt::format(
      "{{\"camera\": {{\"look_at\": {{\"from\": [{0},{0},{1}], \"to\": [{0},{0},0]}}, \"vertical_fov\": "
      "53}},\n"
      "\"environment\": {{\"radiance\": 1}},\n\"materials\": {{{2}}},\n\"meshes\": {{{3}}}}}\n",
      middle, columns, materials, meshes);
}

// The baseline: bilinear in floats that all lie in memory.
Texel bilinear(const Picture& p, const Vec2& uv) {
  const float x = (uv.x - std::floor(uv.x)) * static_cast<float>(p.width) - 0.5f;
  const float y = (uv.y - std::floor(uv.y)) * static_cast<float>(p.height) - 0.5f;
  const float left = std::floor(x), top = std::floor(y);
  const auto at = [](int i, int size) {
    return static_cast<std::size_t>(i < 0 ? size - 1 : i < size ? i : 0);
  };
  const std::size_t columns[2] = {at(int(left), p.width), at(int(left) + 1, p.width)};
  const std::size_t rows[2] = {at(int(top), p.height), at(int(top) + 1, p.height)};
  Texel sum{0, 0, 0, 1};
  for (int j = 0; j < 2; ++j)
    for (int i = 0; i < 2; ++i) {
      const float weight = (i ? x - left : 1 - (x - left)) * (j ? y - top : 1 - (y - top));
      const float* c = p.pixels.data() + (rows[j] * static_cast<std::size_t>(p.width) + columns[i]) * 3;
      for (std::size_t k = 0; k < 3; ++k) sum[k] += weight * c[k];
    }
  return sum;
}

// Nanoseconds a lookup: next to each other, as neighbouring rays have them, and all over the picture.
template <class Lookup>
void time_lookups(std::string_view what, int edge, const Lookup& lookup) {
  constexpr int kCount = 400'000;
  double nanoseconds[2], sum = 0;
  for (const bool scattered : {false, true}) {
    Steps steps;
    const auto begin = Clock::now();
    for (int i = 0; i < kCount; ++i) {
      const float texel = 0.7f / static_cast<float>(edge);
      const Vec2 near(0.1f + static_cast<float>(i % 256) * texel, 0.1f + static_cast<float>(i / 256) * texel);
      sum += lookup(scattered ? Vec2(steps.next(), steps.next()) : near)[0];
    }
    nanoseconds[scattered] = seconds_since(begin) / kCount * 1e9;
  }
  fmt::print("{:<44}{:>9.0f} ns{:>12.0f} ns{}\n", what, nanoseconds[0], nanoseconds[1],
             std::isfinite(sum) ? "" : " (not finite)");
}

void bench_lookups(const Options& o) {
  Scene scene;
  scene.materials.emplace_back().base_color_texture.picture =
      PictureShelf(scene).place(o.folder / "0.png", Encoding::srgb);
  const Picture full = with_pixels(scene.pictures[0]);
  const Textures textures(scene, std::make_shared<TextureCache>(TextureOptions{o.folder / "cache"}));
  fmt::print("{:<44}{:>12}{:>15}\n", "a lookup", "neighbours", "scattered");
  time_lookups("floats in memory, bilinear", full.width, [&](const Vec2& uv) { return bilinear(full, uv); });
  for (const float texels : {0.0f, 1.0f, 1.5f, 4.0f, 64.0f})
    time_lookups(fmt::format("Textures, {} texels wide", texels), full.width, [&](const Vec2& uv) {
      return textures.lookup({.picture = 0}, uv, texels / static_cast<float>(full.width));
    });
  textures.require_sound();
}

void report_memory(std::string_view what, double seconds) {
  fmt::print("{:<44}{:>9.2f} s{:>10.0f} MiB{:>10.0f} MiB\n", what, seconds, status_mib("VmRSS"),
             status_mib("VmHWM"));
}

// The wall, at the finest level throughout: the worst that a limit can meet.
void bench_memory(const Options& o) {
  const auto cache = std::make_shared<TextureCache>(TextureOptions{o.folder / "cache", o.limit << 20});
  fmt::print("\n{:<44}{:>11}{:>14}{:>14}\n",
             fmt::format("{} pictures of {} x {}, {} MiB of texels", o.pictures, o.edge, o.edge, o.limit), "",
             "held now", "held at most");
  auto begin = Clock::now();
  const auto scene = std::make_shared<const Scene>(load_scene(o.folder / "scene.json"));
  report_memory("loaded", seconds_since(begin));
  begin = Clock::now();
  const auto ready = prepare(scene, {}, 0, cache);
  report_memory("prepared", seconds_since(begin));
  begin = Clock::now();
  const RenderSettings settings{.size = {960, 960}, .max_bounces = 1};
  for (const Region& cell : grid_cells({0, 0, 960, 960}, {kCellEdge, kCellEdge}))
    render(*ready, settings, 0, cell, {0, 8});
  report_memory("rendered, 960 x 960, 8 samples", seconds_since(begin));
  fmt::print("{:<44}{:>25.0f} MiB\n", "of which texels", double(cache->memory_used()) / (1 << 20));
  fmt::print("{:<44}{:>25.0f} MiB\n", "all finest levels, as halves",
             6.0 * o.edge * o.edge * o.pictures / (1 << 20));
}

int run(Options o) {
  const bool temporary = o.folder.empty();
  if (temporary) o.folder = fs::temp_directory_path() / fmt::format("tessera-texture-bench-{}", getpid());
  fs::create_directories(o.folder);
  write_scene(o);
  bench_memory(o);
  fmt::print("\n");
  bench_lookups(o);
  if (temporary) fs::remove_all(o.folder);
  return 0;
}

}  // namespace
}  // namespace tessera

int main(int count, char** words) {
  tessera::Options o;
  if (count > 1) o.pictures = std::atoi(words[1]);
  if (count > 2) o.edge = std::atoi(words[2]);
  if (count > 3) o.limit = static_cast<std::uint64_t>(std::atoi(words[3]));
  if (count > 4) o.folder = words[4];
  try {
    return tessera::run(o);
  } catch (const std::exception& e) {
    fmt::print(stderr, "{}\n", e.what());
    return 3;
  }
}
