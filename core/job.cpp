// SPDX-License-Identifier: Apache-2.0
#include "core/job.h"

#include <fmt/format.h>
#include <algorithm>
#include <bit>
#include <cmath>

#include "core/error.h"
#include "core/plan.h"
#include "core/sample_range.h"
#include "core/sha256.h"

namespace tessera {
namespace {

void require(bool good, std::string_view field, const std::string& value, std::string_view accepted) {
  if (!good) throw InputError(fmt::format("job: {}", field), "is " + value, accepted);
}

void require_range(double v, double low, double high, std::string_view field) {
  require(v >= low && v <= high, field, fmt::format("{}", v), fmt::format("{} to {}", low, high));
}

bool is_power_of_two(int n) { return n > 0 && std::has_single_bit(static_cast<unsigned>(n)); }

void validate(const AcceptanceRule& rule) {
  require(is_power_of_two(rule.first_samples) && rule.first_samples >= kLeafSamples &&
              rule.first_samples <= 65536,
          "first_samples", std::to_string(rule.first_samples), "a power of two from 8 to 65536");
  require(is_power_of_two(rule.max_samples) && rule.max_samples >= rule.first_samples &&
              rule.max_samples <= kMaxSamples,
          "max_samples", std::to_string(rule.max_samples),
          fmt::format("a power of two from first_samples to {}", kMaxSamples));
  if (rule.relmse)
    require(*rule.relmse > 0 && std::isfinite(*rule.relmse), "relmse", fmt::format("{}", *rule.relmse),
            "a number above 0");
  if (rule.max_seconds)
    require(*rule.max_seconds > 0 && std::isfinite(*rule.max_seconds), "max_seconds",
            fmt::format("{}", *rule.max_seconds), "a number above 0");
}

void validate(const Given& given, const Job& job) {
  require(is_digest(given.planes), "given.planes", "no digest", "64 hexadecimal digits");
  require(is_window(given.display), "given.display", "no region", "1 to 65536 pixels an edge");
  require(job.crop && is_window(*job.crop), "crop", "no region", "1 to 65536 pixels an edge");
  require(job.scene == SceneRef{}, "scene", "named", "none, as the frame is given");
}

// What a filter takes over a tile's outer region is one message.
void validate_tile(const Job& job) {
  const double width = std::min(job.tile.width + 2 * job.filter.halo(), job.region().width());
  const double height = std::min(job.tile.height + 2 * job.filter.halo(), job.region().height());
  const double bytes = width * height * filter_shape(job).taken * sizeof(float);
  require(bytes <= kMaxPixelBytes, "tile",
          fmt::format("{}x{}: with its halo more than 1 GiB", job.tile.width, job.tile.height),
          "a smaller tile");
}

}  // namespace

bool is_window(const Region& r) {
  return std::min(r.x0, r.y0) >= -kFarthest && std::max(r.x1, r.y1) <= kFarthest + 1 && !r.empty() &&
         r.width() <= kMaxEdge && r.height() <= kMaxEdge;
}

void validate(const Job& job) {
  const Size size = job.render.size;
  require_range(size.width, 1, kMaxEdge, "width");
  require_range(size.height, 1, kMaxEdge, "height");
  require_range(job.render.max_bounces, 0, kMaxBounces, "max_bounces");
  require_range(job.render.sure_bounces, 0, kMaxBounces, "sure_bounces");
  require_range(job.render.clamp_direct, 0, 1e30, "clamp_direct");
  require_range(job.render.clamp_indirect, 0, 1e30, "clamp_indirect");
  require_range(job.render.regularise, 0, 1, "regularise");
  require_range(job.tile.width, 1, kMaxEdge, "tile width");
  require_range(job.tile.height, 1, kMaxEdge, "tile height");
  require_range(job.task_samples, 1, 1 << 30, "task_samples");
  const Region whole{0, 0, size.width, size.height};
  if (job.given)
    validate(*job.given, job);
  else if (job.crop)
    require(!job.crop->empty() && whole.contains(*job.crop), "crop",
            fmt::format("{} {} {} {}", job.crop->x0, job.crop->y0, job.crop->x1, job.crop->y1),
            "a region with pixels inside the frame");
  require(job.render.camera.size() <= kMaxName, "camera", "a name too long",
          fmt::format("{} bytes", kMaxName));
  require(job.render.variant.size() <= kMaxName, "variant", "a name too long",
          fmt::format("{} bytes", kMaxName));
  require(job.scene.bundle.empty() || is_digest(job.scene.bundle), "scene.bundle", "no digest",
          "64 hexadecimal digits, or none");
  validate(job.filter);
  validate(job.acceptance);
  validate_tile(job);
}

}  // namespace tessera
