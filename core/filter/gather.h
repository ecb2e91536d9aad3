// SPDX-License-Identifier: Apache-2.0
// What a filter takes, gathered from files that some renderer has written.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "core/exr.h"
#include "core/filter/filter.h"

namespace tessera {

struct Sources {
  const ExrImage* picture = nullptr;  // of which the region is filtered
  std::map<std::string, ExrImage>
      separate;  // by layer ("albedo", "N", "Z", ...): files of that layer alone, or among others
  std::optional<double> samples;  // per pixel, where no file says how many
  // By what motion vectors are multiplied, to be pixels per frame to the right and down, in place of what is
  // known of their names; without it, those whose unit is not known are not taken.
  std::optional<std::array<float, 2>> motion_scale = {};
  bool resting = false;    // where there are no motion vectors, nothing moves
  bool backwards = false;  // for a filter that goes from the last frame to the first
};

struct Gathered {
  Image input;                       // plan.inputs() over the picture's data window
  std::vector<std::string> notices;  // what was not there, and what stands in for it
  std::vector<std::string> defects;  // what is broken in this picture
  std::vector<std::string> broken;   // how many pixels of which plane are not finite: they come out black
  std::set<std::string> asked_for;   // layers that were looked for
};

// Depths that mean sky become kSkyDepth, motion that cannot be leads nowhere (see stand_ins.h). What can be
// found in no file: the variance of direct light is that of the picture, where all light is direct; variances of
// light are estimated from the picture; other variances count as 0; halves are the whole; emission is none; direct and indirect light are filtered as one; of what temporal filters take,
// the depth before is the depth now, geometric normals are shading normals, ids are 0 and depth's gradient is
// its difference between pixels. All of that is said in the notices. Throws InputError that names the layer
// for anything else, motion among them, and for files of another size.
Gathered gather(const FilterPlan&, const Sources&, const std::string& name_of_picture);

// Metadata of what only the scene knows: numbers, as text to all of their bits.
inline constexpr char kDiameterKey[] = "tessera/diameter", kLightKey[] = "tessera/light";

struct FoundFacts {
  SceneFacts facts;
  std::vector<std::string> notices;  // of those that the filter asks for, what is not known
};
// The scene's facts as far as a frame tells them: what its metadata say, else the diagonal of what P holds, else the
// largest depth.
FoundFacts facts_of(const FilterPlan&, const Image& input, const Sources&);
// Whether a parameter of it is a fact of the scene.
bool asks_for_scene(const FilterPlan&);

}  // namespace tessera
