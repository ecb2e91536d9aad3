// SPDX-License-Identifier: Apache-2.0
#include "cli/render_output.h"

#include <fmt/format.h>

#include "cli/version.h"
#include "coordinator/output.h"
#include "core/png.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

template <typename T>
std::vector<std::string> names_of(const std::vector<T>& things) {
  std::vector<std::string> names;
  for (const T& t : things) names.push_back(t.name);
  return names;
}

// The picture with its coverage, where the scene stands before nothing.
Image preview(const Scene& scene, const ExrImage& exr) {
  std::vector<float> data;
  for (const char* channel : {"R", "G", "B", "A"}) {
    if (*channel == 'A' && scene.background.kind != Background::Kind::transparent) continue;
    const auto plane = exr.pixels.plane(exr.plane(channel));
    data.insert(data.end(), plane.begin(), plane.end());
  }
  const int planes = static_cast<int>(data.size() / exr.pixels.plane(0).size());
  return {exr.pixels.region(), planes, std::move(data)};
}

}  // namespace

void write_frame(const RenderOptions& o, const fs::path& file, const Job& job, const Scene& scene,
                 const JobReport& report, const std::string& key) {
  Provenance from{.version = std::string(kVersion),
                  .device = fmt::format("{}", fmt::join(report.device_classes, "; ")),
                  .scene_hash = job.scene.hash,
                  .seconds = report.seconds,
                  .light_groups = scene.light_groups,
                  .objects = names_of(scene.objects),
                  .materials = names_of(scene.materials),
                  .dropped = report.dropped,
                  .key = key};
  if (!o.layers_for.empty()) from.filter_inputs = parse_filter(o.layers_for).inputs();
  const ExrImage image = layered(job, report.image, from);
  write_exr(file, image, o.compression);
  write_png(fs::path(file).replace_extension(".png"), preview(scene, image), static_cast<float>(o.exposure));
}

ExitCode exit_code(const Job& job, const JobReport& report) {
  if (report.failure) return report.bad_input ? ExitCode::bad_input : ExitCode::job_failed;
  const StopReason why = report.image.stop.value_or(StopReason::interrupted);
  if (why == StopReason::interrupted) return ExitCode::interrupted;
  // Without a target there is nothing to fall short of.
  const bool done = why == StopReason::accepted || !job.acceptance.relmse;
  return done ? ExitCode::done : ExitCode::stopped_at_limit;
}

void summarise(const Job& job, const JobReport& report, const fs::path& file) {
  const double samples = static_cast<double>(report.image.pixel_samples);
  fmt::print("{}\n{:.1f} M pixel samples ({:.1f} per pixel) in {} rounds, {:.1f} s\n{}\n",
             verdict(job, report.image), samples * 1e-6, samples / static_cast<double>(job.region().area()),
             report.image.rounds, report.seconds, file.string());
  if (report.dropped > 0) fmt::print("{} samples were not finite and were dropped\n", report.dropped);
}

// What the scene was made from is not to be written over.
void require_foreign(const fs::path& file, const RenderOptions& o, const Scene& scene) {
  std::vector<fs::path> sources{o.scene};
  for (const Picture& picture : scene.pictures) {
    sources.emplace_back(picture.name);
    for (const Picture& tile : picture.tiles) sources.emplace_back(tile.name);
  }
  for (const char* extension : {".exr", ".png"})
    for (const fs::path& source : sources) {
      const fs::path target = fs::path(file).replace_extension(extension);
      std::error_code none;
      if (fs::equivalent(target, source, none))
        throw Error(ExitCode::bad_usage,
                    fmt::format("--output: '{}' is a file of the scene itself", target.string()));
    }
}

}  // namespace tessera
