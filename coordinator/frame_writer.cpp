// SPDX-License-Identifier: Apache-2.0
#include "coordinator/frame_writer.h"

#include <fmt/format.h>

#include "coordinator/output.h"
#include "core/exr.h"
#include "core/layers.h"
#include "core/png.h"
#include "core/sha256.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// The picture, with its coverage where the scene stands before nothing.
Image preview(const ExrImage& exr, bool transparent) {
  Floats data;
  for (const char* channel : {"R", "G", "B", "A"}) {
    if (*channel == 'A' && !transparent) continue;
    const auto plane = exr.pixels.plane(exr.plane(channel));
    data.insert(data.end(), plane.begin(), plane.end());
  }
  const int planes = static_cast<int>(data.size() / exr.pixels.plane(0).size());
  return {exr.pixels.region(), planes, std::move(data)};
}

}  // namespace

FrameStyle style_of(const Submission& s, const std::string& version) {
  FrameStyle style{.version = version,
                   .names = s.names,
                   .transparent = s.transparent,
                   .compression = s.compression,
                   .exposure = s.exposure,
                   .facts = s.facts};
  if (!s.layers_for.empty()) style.filter_inputs = parse_filter(s.layers_for).inputs();
  return style;
}

std::string file_key(const std::string& image_key, const FrameStyle& style) {
  const FrameStyle usual;
  if (style.filter_inputs.empty() && style.compression == usual.compression) return image_key;
  std::string text = fmt::format("{} {}", image_key, style.compression);
  for (const Channel& c : style.filter_inputs) text += " " + file_channel(c);
  return sha256(text);
}

void write_frame(const fs::path& exr, const fs::path& png, const Job& job, const JobReport& report,
                 const FrameStyle& style, const std::string& key) {
  const Provenance from{.version = style.version,
                        .device = fmt::format("{}", fmt::join(report.device_classes, "; ")),
                        .scene_hash = job.scene.hash,
                        .seconds = report.seconds,
                        .light_groups = style.names.light_groups,
                        .objects = style.names.objects,
                        .materials = style.names.materials,
                        .dropped = report.dropped,
                        .key = key.empty() ? "" : file_key(key, style),
                        .filter_inputs = style.filter_inputs,
                        .facts = style.facts};
  const ExrImage image = layered(job, report.image, from);
  write_exr(exr, image, style.compression);
  write_png(png, preview(image, style.transparent), static_cast<float>(style.exposure));
}

// Without a target there is nothing to fall short of.
bool fell_short(const Job& job, const FrameImage& image) {
  if (job.given) return image.stop != StopReason::filtered;
  return job.acceptance.relmse.has_value() && image.stop != StopReason::accepted;
}

}  // namespace tessera
