// SPDX-License-Identifier: Apache-2.0
#include "cli/render_options.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cmath>

#include "cli/limit_options.h"
#include "cli/picture_options.h"
#include "cli/sizes.h"
#include "core/error.h"
#include "core/sample_range.h"

namespace tessera {
namespace {

constexpr std::array<std::pair<std::string_view, double>, 3> kTargets{
    {{"draft", 1e-2}, {"good", 2.5e-3}, {"final", 5e-4}}};
constexpr int kMostThreads = 1024;
constexpr std::string_view kLightGroups = "light_groups";
constexpr std::array kProgress{"auto", "bar", "lines", "json", "openjd", "none"};

template <class Number>
std::optional<Number> number(std::string_view text) {
  Number value{};
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Light groups are asked for all at once.
bool has_name(int a) { return is_aov(a) && !is_light_group(a); }
std::string_view asked_as(const AovInfo& i) { return i.name.empty() ? i.letters : i.name; }

std::string aov_names() {
  std::string all;
  for (int a = 1; a < kAovs; ++a)
    if (has_name(a)) all += fmt::format("{}, ", asked_as(info(static_cast<Aov>(a))));
  return all + std::string(kLightGroups);
}

AovSet parse_aovs(const std::vector<std::string>& names) {
  AovSet set;
  for (const std::string& name : names) {
    if (name == kLightGroups) continue;  // as many as the scene has: see groups_of()
    const auto is_it = [&](int a) { return has_name(a) && name == asked_as(info(static_cast<Aov>(a))); };
    int a = 1;
    while (a < kAovs && !is_it(a)) ++a;
    if (a == kAovs) refuse_option("--aov", name, aov_names());
    set = set | AovSet{static_cast<Aov>(a)};
  }
  return set;
}

// Sample counts double from round to round, so the most is a power of two.
int most_samples(int asked) {
  if (asked < 1 || asked > kMaxSamples)
    refuse_option("--samples", std::to_string(asked), fmt::format("1 to {}", kMaxSamples));
  return std::max(kLeafSamples, static_cast<int>(std::bit_ceil(static_cast<unsigned>(asked))));
}

}  // namespace

double parse_target(const std::string& text) {
  for (const auto& [name, value] : kTargets)
    if (text == name) return value;
  const std::string_view digits = std::string_view(text).substr(text.starts_with("relmse=") ? 7 : 0);
  const auto value = number<double>(digits);
  if (!value || !(*value > 0) || !std::isfinite(*value))
    refuse_option("--until", text, "draft, good, final, or relmse=X with X above 0");
  return *value;
}

Region crop_region(const std::vector<double>& ndc, Size frame) {
  for (double v : ndc)
    if (!(v >= 0 && v <= 1)) refuse_option("--crop", fmt::format("{}", v), "x0 y0 x1 y1, each 0 to 1");
  if (ndc.size() != 4 || !(ndc[0] < ndc[2] && ndc[1] < ndc[3]))
    refuse_option("--crop", fmt::format("{}", fmt::join(ndc, " ")), "x0 y0 x1 y1 with x0 < x1 and y0 < y1");
  const auto pixel = [](double v, int edge) { return static_cast<int>(std::lround(v * edge)); };
  Region r{pixel(ndc[0], frame.width), pixel(ndc[1], frame.height), pixel(ndc[2], frame.width),
           pixel(ndc[3], frame.height)};
  r.x0 = std::min(r.x0, frame.width - 1);
  r.y0 = std::min(r.y0, frame.height - 1);
  r.x1 = std::max(r.x1, r.x0 + 1);
  r.y1 = std::max(r.y1, r.y0 + 1);
  return r;
}

// What image, of what, and when it is good enough.
void describe_job(CLI::App& app, RenderOptions& o) {
  app.add_option("scene", o.scene, "Scene file: .json (native), .gltf, .glb, .obj, .fbx or .ply")
      ->envname("TESSERA_SCENE");
  app.add_option(
         "--until", o.until,
         "Stop when the relMSE of every part of the image is below: draft (0.01), good (0.0025), final\n"
         "(0.0005) or relmse=X [good, unless --samples or --time is given]")
      ->envname("TESSERA_UNTIL");
  app.add_option(
         "--samples", o.samples,
         fmt::format("Most samples per pixel, rounded up to a power of two, {} at least [4096]; without "
                     "--until, what every pixel gets",
                     kLeafSamples))
      ->envname("TESSERA_SAMPLES");
  app.add_option("--time", o.seconds, "Most seconds; the image of the last complete round is written")
      ->envname("TESSERA_TIME");
  app.add_option("--filter", o.filter, "Denoiser, e.g. none, atrous, svgf:sigma_l=2 (see tessera filters)")
      ->envname("TESSERA_FILTER")
      ->capture_default_str();
  app.add_option("--width", o.width, "Pixels")->envname("TESSERA_WIDTH")->capture_default_str();
  app.add_option("--height", o.height, "Pixels")->envname("TESSERA_HEIGHT")->capture_default_str();
  app.add_option("--crop", o.crop, "Part of the frame to render: x0 y0 x1 y1, 0 to 1 from the top left")
      ->expected(4);
  app.add_option("--camera", o.camera, "Name of the camera [the scene's first]")->envname("TESSERA_CAMERA");
  app.add_option("--variant", o.variant, "Name of the material variant [none]")->envname("TESSERA_VARIANT");
  app.add_option("--seed", o.seed, "Seed of all randomness")->envname("TESSERA_SEED")->capture_default_str();
  auto* frame = app.add_option("--frame", o.frame, "Frame number");
  frame->envname("TESSERA_FRAME")->capture_default_str();
  app.add_option("--frames", o.frames,
                 "Shot: 1-60, 1-100x2,150. Frames whose files are there and whole are left out")
      ->envname("TESSERA_FRAMES")
      ->excludes(frame);
  app.add_option("--cuts", o.cuts,
                 "With history=on: frames that go by none before, as in --frames [where the camera jumps]");
  app.add_option("--max-bounces", o.max_bounces, "Scatterings after the first hit")
      ->envname("TESSERA_MAX_BOUNCES")
      ->capture_default_str();
  app.add_option("--tile-size", o.tile_size,
                 "Tiles for filtering: N or WxH pixels; does not change the image")
      ->envname("TESSERA_TILE_SIZE")
      ->capture_default_str();
  app.add_option("--sure-bounces", o.sure_bounces,
                 "Bounces before Russian roulette begins; as many as --max-bounces: none")
      ->envname("TESSERA_SURE_BOUNCES")
      ->capture_default_str();
  app.add_option("--clamp-direct", o.clamp_direct, "Most that a light adds to a sample, 0: no limit; biased")
      ->envname("TESSERA_CLAMP_DIRECT")
      ->capture_default_str();
  app.add_option("--clamp-indirect", o.clamp_indirect,
                 "The same for light that came by more than one surface")
      ->envname("TESSERA_CLAMP_INDIRECT")
      ->capture_default_str();
  app.add_option("--regularise", o.regularise,
                 "Least GGX alpha of reflections seen by diffuse surfaces, 0: exact; biased, tames caustics")
      ->envname("TESSERA_REGULARISE")
      ->capture_default_str();
  app.add_option("--aov", o.aovs, fmt::format("More layers to write: {}", aov_names()))->delimiter(',');
  app.add_option("--layers-for", o.layers_for,
                 "A filter: write all that it takes, to all of its bits, for tessera denoise");
  add_limit_option(app, o.limits);
  add_picture_options(app, o.compression, o.exposure);
}

// How it is made here, and where it goes.
void describe(CLI::App& app, RenderOptions& o) {
  describe_job(app, o);
  app.add_option("-o,--output", o.output,
                 "EXR to write, of a shot name.####.exr; a PNG preview goes beside it [<scene>.exr]")
      ->envname("TESSERA_OUTPUT");
  app.add_option("--threads", o.threads, "Threads [what this process may use]")->envname("TESSERA_THREADS");
  app.add_option("--texture-memory", o.texture_memory, "MiB of textures held in memory")
      ->check(CLI::Range(std::uint64_t{16}, std::uint64_t{1} << 24))
      ->envname("TESSERA_TEXTURE_MEMORY")
      ->capture_default_str();
  app.add_option("--device", o.device, "OpenCL device: number or part of its name [first CPU]")
      ->envname("TESSERA_DEVICE");
  app.add_flag("--list-devices", o.list_devices, "List the OpenCL devices and end");
  app.add_option("--progress", o.progress, "How to show it")
      ->check(CLI::IsMember(std::vector<std::string>(kProgress.begin(), kProgress.end())))
      ->envname("TESSERA_PROGRESS")
      ->capture_default_str();
  app.add_flag("--quiet", o.quiet, "No progress and no summary");
  add_log_options(app, o.log);
}

AovSet groups_of(const RenderOptions& o, std::size_t groups) {
  AovSet set;
  if (std::find(o.aovs.begin(), o.aovs.end(), kLightGroups) == o.aovs.end()) return set;
  for (std::size_t g = 0; g < groups; ++g) set = set | AovSet{light_group_aov(static_cast<int>(g))};
  return set;
}

// Sums over samples have leaves of that many, so that they come out the same however the work is split.
void warn_of_few_samples(const RenderOptions& o) {
  if (o.samples && *o.samples < kLeafSamples)
    spdlog::warn("--samples {}: at least {} are taken", *o.samples, kLeafSamples);
}

Job job_of(const RenderOptions& o) {
  Job job;
  job.scene.path = o.scene;
  job.render.size = {o.width, o.height};
  job.render.seed = o.seed;
  job.render.max_bounces = o.max_bounces;
  job.render.sure_bounces = o.sure_bounces;
  job.render.clamp_direct = static_cast<float>(o.clamp_direct);
  job.render.clamp_indirect = static_cast<float>(o.clamp_indirect);
  job.render.regularise = static_cast<float>(o.regularise);
  job.render.camera = o.camera;
  job.render.variant = o.variant;
  job.filter = parse_filter(o.filter);
  job.render.aovs = AovSet{Aov::color} | parse_aovs(o.aovs);
  if (!o.layers_for.empty()) job.render.aovs = job.render.aovs | aovs_of(parse_filter(o.layers_for).inputs());
  job.frame = o.frame;
  job.tile = tile_size_option(o.tile_size);
  if (!o.until.empty() || (!o.samples && !o.seconds))
    job.acceptance.relmse = parse_target(o.until.empty() ? "good" : o.until);
  if (o.samples) job.acceptance.max_samples = most_samples(*o.samples);
  job.acceptance.first_samples = std::min(job.acceptance.first_samples, job.acceptance.max_samples);
  if (o.seconds && !(*o.seconds > 0 && std::isfinite(*o.seconds)))
    refuse_option("--time", fmt::format("{}", *o.seconds), "seconds above 0");
  job.acceptance.max_seconds = o.seconds;
  if (o.threads && (*o.threads < 1 || *o.threads > kMostThreads))
    refuse_option("--threads", std::to_string(*o.threads), fmt::format("1 to {}", kMostThreads));
  try {
    if (!o.crop.empty() && o.width > 0 && o.height > 0) job.crop = crop_region(o.crop, job.render.size);
    validate(job);
  } catch (const InputError& e) {
    throw Error(ExitCode::bad_usage, e.what());
  }
  return job;
}

}  // namespace tessera
