// SPDX-License-Identifier: Apache-2.0
#include "cli/render_output.h"

#include <fmt/format.h>

#include "coordinator/frame_writer.h"
#include "coordinator/output.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

}  // namespace

ExitCode exit_code(const Job& job, const JobReport& report) {
  if (report.failure) return report.bad_input ? ExitCode::bad_input : ExitCode::job_failed;
  const StopReason why = report.image.stop.value_or(StopReason::interrupted);
  if (why == StopReason::interrupted) return ExitCode::interrupted;
  return fell_short(job, report.image) ? ExitCode::stopped_at_limit : ExitCode::done;
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
