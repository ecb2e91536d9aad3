// SPDX-License-Identifier: Apache-2.0
// What a user asks for, as plain values.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>

#include "core/filter/filter.h"
#include "core/region.h"
#include "core/sha256.h"

namespace tessera {

inline constexpr int kMaxEdge = 65536;  // pixels, width or height of a frame
inline constexpr int kMaxBounces = 1024;
inline constexpr std::size_t kMaxName = 256;                         // bytes of a name
inline constexpr std::size_t kMaxPixelBytes = std::size_t{1} << 30;  // that travel in one message

// Which scene: where a worker may load it, and what it must then be.
struct SceneRef {
  std::string path;    // of the scene file; in the bundle, if there is one
  std::string hash;    // content hash of the loaded scene (hex), see scene/load.h
  std::string bundle;  // digest of the bundle it travels in (core/bundle.h); empty: it is on this machine
  bool operator==(const SceneRef&) const = default;
};

// Everything that decides the samples of a frame, besides the scene.
struct RenderSettings {
  Size size{960, 540};  // pixels of the whole frame
  std::uint64_t seed = 0;
  int max_bounces = 8;   // scatterings after the first hit; 0 = direct light only
  int sure_bounces = 2;  // before Russian roulette begins; max_bounces: never
  std::string camera;    // name; empty = the scene's first
  std::string variant;   // of the scene's materials; empty = as the meshes say
  // Each light's share of a sample is scaled down until no channel exceeds this; 0: never. Biased.
  float clamp_direct = 0, clamp_indirect = 0;
  // After a path's first scattering that is no mirror, lobes of a smaller GGX alpha get this one; 0: never.
  // Biased (Kaplanyan and Dachsbacher 2013).
  float regularise = 0;
  AovSet aovs{Aov::color};
  bool operator==(const RenderSettings&) const = default;
};

// When a frame is good enough, and when to give up. See core/acceptance.h.
struct AcceptanceRule {
  std::optional<double> relmse;  // target of every cell and of the frame; none: render max_samples and stop
  int first_samples = 16;        // of the first look; a power of two >= kLeafSamples
  int max_samples = 4096;        // per pixel; a power of two multiple of first_samples
  std::optional<double> max_seconds;  // of wall time, looked at when a round ends
  bool operator==(const AcceptanceRule&) const = default;
};

// Of a frame that is not rendered, but comes as the planes that its filter takes. Its region is Job::crop.
struct Given {
  Digest planes;         // the blob that holds them, see core/filter/given.h
  Region display;        // the whole picture, of which they may be a part, or more than that
  bool goes_on = false;  // by what the frame that is before it in its job keeps
  bool operator==(const Given&) const = default;
};

struct Job {
  SceneRef scene;
  RenderSettings render;
  int frame = 0;               // frame number; a coordinate of the randomness
  std::optional<Region> crop;  // pixels; only these are rendered and written
  std::optional<Given> given;  // none: it is rendered
  FilterPlan filter;
  AcceptanceRule acceptance;
  Size tile{256, 256};         // inner size of the tiles in which the frame is filtered
  int task_samples = 1 << 18;  // pixel samples a render task holds (plan.h), if a leaf allows
  bool cut = false;            // comes before it: it goes by nothing that the frame before has kept

  Region region() const { return crop.value_or(Region{0, 0, render.size.width, render.size.height}); }
  bool operator==(const Job&) const = default;
};

// Whether pixels may be there: 1 to kMaxEdge along each edge, and no farther out than leaves room for halos.
inline constexpr int kFarthest = 1 << 30;
bool is_window(const Region&);

// Throws InputError that names the field, unless every number is in its range.
void validate(const Job&);

}  // namespace tessera
