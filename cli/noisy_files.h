// SPDX-License-Identifier: Apache-2.0
// The files of a frame that is denoised: what the filter takes of them, and what is written of its result.
#pragma once

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "cli/denoise.h"
#include "core/filter/gather.h"

namespace tessera {

struct NoisyFrame {
  std::filesystem::path in, out;
  ExrImage picture;
  Gathered gathered;
  SceneFacts facts;
  FilterPlan plan;  // resolved with these

  const Region& region() const { return picture.pixels.region(); }
};

class NoisyFiles {
 public:
  // Borrows the options. Throws Error(bad_usage) that says what is accepted.
  explicit NoisyFiles(const DenoiseOptions&);

  const FilterPlan& plan() const { return plan_; }
  // What the first of these frames that can be read tells of the scene counts for all, if the filter asks: its
  // parameters do not change within a shot.
  void take_facts_of(const std::vector<int>& frames);
  // `frame` replaces the places for numbers; none: there are none. A single image needs no motion.
  NoisyFrame read(std::optional<int> frame, bool backwards = false) const;
  // The picture of a frame that was read, and forgotten since. Throws InputError unless it covers the same
  // pixels as before.
  void read_again(NoisyFrame&, const Region& before) const;
  // The picture with its R, G and B replaced, and a preview.
  void write(const NoisyFrame&, const Image& rgb) const;

 private:
  // "albedo=albedo.####.exr"
  struct Guide {
    std::string layer, file;
  };
  static std::vector<Guide> guides_of(const DenoiseOptions&);
  void take_facts(NoisyFrame&, const Sources&, int number) const;
  void say_what_is_not_taken(NoisyFrame&) const;

  const DenoiseOptions& options_;
  FilterPlan plan_;
  std::vector<Guide> guides_;
  std::optional<std::array<float, 2>> motion_scale_;
  std::optional<SceneFacts> facts_;  // of the whole shot
};

}  // namespace tessera
