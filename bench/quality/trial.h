// SPDX-License-Identifier: Apache-2.0
// A scene rendered step by step, with all that filters take, and a reference of it that is kept between runs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>

#include "core/film.h"
#include "core/filter/filter.h"
#include "core/job.h"
#include "core/scene/scene.h"
#include "worker/render/render.h"

namespace tessera::quality {

class Trial {
 public:
  // Reads `scene`; the film will hold `aovs`.
  Trial(const std::filesystem::path& scene, Size size, AovSet aovs);

  const Region& frame() const { return frame_; }
  const SceneFacts& facts() const { return facts_; }
  // Renders up to `samples` per pixel: a power of two, not below what is there.
  void render_to(int samples);
  // The planes that a filter takes, of all samples.
  Image input(const FilterPlan&) const;
  Image noisy() const;

 private:
  friend struct Reference reference_of(const Trial&, int, const std::filesystem::path&);

  std::shared_ptr<const Scene> scene_;
  std::shared_ptr<const RenderScene> ready_;
  Region frame_;
  RenderSettings settings_;
  SceneFacts facts_;
  Film film_;
};

// The mean of `samples` per pixel that no trial has, and the variance of that mean: three planes each.
struct Reference {
  Image mean, variance;
};
// Read from `folder` if it is there, else rendered and written to it.
Reference reference_of(const Trial&, int samples, const std::filesystem::path& folder);

}  // namespace tessera::quality
