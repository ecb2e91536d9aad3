// SPDX-License-Identifier: Apache-2.0
// A frame of a scene rendered step by step, with all that filters take, and a reference of it that is kept
// between runs.
#pragma once

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "core/film.h"
#include "core/filter/filter.h"
#include "core/job.h"
#include "core/scene/scene.h"
#include "worker/render/render.h"

namespace tessera::judging {

// A scene ready for rays at one frame.
struct Scenery {
  std::shared_ptr<const Scene> scene;
  std::string hash;  // of the scene's content
  std::shared_ptr<const RenderScene> ready;
};

class Trial {
 public:
  // The film will hold `aovs`.
  Trial(Scenery, Size size, AovSet aovs, int number);

  const Region& frame() const { return frame_; }
  const SceneFacts& facts() const { return facts_; }
  // Renders up to `samples` per pixel: a power of two, not below what is there.
  void render_to(int samples);
  // The planes that a filter takes, of all samples.
  Image input(const FilterPlan&) const;
  Image noisy() const;

 private:
  friend struct Reference reference_of(const Trial&, int, const std::filesystem::path&);

  Scenery scenery_;
  Region frame_;
  int number_;
  RenderSettings settings_;
  SceneFacts facts_;
  Film film_;
};

// What filters, given as parse_filter() reads them, want of a film, and its color.
AovSet aovs_for(const std::vector<std::string>& filters);

// A scene, frame by frame.
class Shot {
 public:
  Shot(const std::filesystem::path& scene, Size size);
  // Frame `number` with nothing rendered yet.
  Trial trial(AovSet aovs, int number = 0);

 private:
  Size size_;
  Scenery scenery_;
  std::string prepared_;  // for which frames scenery_.ready stands
};

// The mean of `samples` per pixel that no trial has, the variance of that mean, and the means of two
// independent halves of those samples: three planes each.
struct Reference {
  Image mean, variance, a, b;
};
// Read from `folder` if it is there, else rendered and written to it.
Reference reference_of(const Trial&, int samples, const std::filesystem::path& folder);

}  // namespace tessera::judging
