// SPDX-License-Identifier: Apache-2.0
#include "coordinator/resume.h"

#include <fmt/format.h>

#include <algorithm>

#include "coordinator/shot.h"
#include "core/sha256.h"

namespace tessera {

std::string image_key(const Job& job, std::string_view before) {
  const RenderSettings& r = job.render;
  const AcceptanceRule& a = job.acceptance;
  const Region region = job.region();
  std::string text = fmt::format(
      "{} {} {}x{} {} {} {} {} {} {:a} {:a} {:a} {:x} {},{},{},{} {}", before, job.scene.hash, r.size.width,
      r.size.height, r.seed, r.max_bounces, r.sure_bounces, r.camera.size(), r.camera, r.clamp_direct,
      r.clamp_indirect, r.regularise, r.aovs.bits(), region.x0, region.y0, region.x1, region.y1, job.frame);
  text += fmt::format(" {} {} {:a} {} {} {:a} {}", r.variant.size(), r.variant, a.relmse.value_or(-1),
                      a.first_samples, a.max_samples, a.max_seconds.value_or(-1), job.filter.name);
  if (job.given) text += " " + job.given->planes;
  for (const auto& [name, value] : job.filter.parameters) text += fmt::format(" {}={:a}", name, value);
  return sha256(text);
}

std::vector<std::string> image_keys(const std::vector<Job>& frames) {
  std::vector<std::string> keys;
  for (std::size_t i = 0; i < frames.size(); ++i) {
    const bool goes_on = i > 0 && continues(frames[i - 1], frames[i]);
    keys.push_back(image_key(frames[i], goes_on ? keys[i - 1] : ""));
  }
  return keys;
}

std::string key_as_made(const std::vector<Job>& frames, const std::vector<std::string>& keys,
                        std::size_t frame, bool continued) {
  return image_key(frames[frame], continued ? keys[frame - 1] : "");
}

Remaining remaining(const std::vector<Job>& frames, const std::vector<std::string>& keys,
                    const std::vector<bool>& done, std::string_view kept) {
  std::vector<bool> wanted(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) wanted[i] = !done[i];
  Remaining r;
  for (std::size_t i = frames.size(); i-- > 1;) {
    if (!wanted[i] || wanted[i - 1] || !continues(frames[i - 1], frames[i])) continue;
    if (!kept.empty() && kept == keys[i - 1])
      r.from_kept.push_back(i);
    else
      wanted[i - 1] = true;
  }
  for (std::size_t i = 0; i < frames.size(); ++i)
    if (wanted[i]) r.frames.push_back(i);
  return r;
}

}  // namespace tessera
