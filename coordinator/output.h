// SPDX-License-Identifier: Apache-2.0
// What a frame looks like in a file: layers, names and metadata. No I/O.
#pragma once

#include <string>
#include <vector>

#include "coordinator/frame.h"
#include "core/exr.h"

namespace tessera {

// What the file says of itself besides its pixels.
struct Provenance {
  std::string version, device, scene_hash;
  double seconds = 0;
  std::vector<std::string> light_groups = {}, objects = {}, materials = {};  // names that layers speak of
  std::uint64_t dropped = 0;                                                 // samples that were not finite
  std::string key = {};                     // of the image, see resume.h; empty: it is none to keep
  std::vector<Channel> filter_inputs = {};  // what a filter takes: written to all of their bits
  SceneFacts facts = {};                    // what it takes of the scene
};

// Layers: R,G,B,A (filtered); noisy.*, variance.* (of the noisy mean); samples.Y; error.Y (relMSE of the
// pixel's cell); and every AOV the film holds under its own name: means (in half, where they are colours),
// and of those with squares the variance of the mean as name_variance.*; light groups under their names;
// mattes as Cryptomatte. Of a frame that was given R,G,B alone, to all of their bits. Metadata under
// tessera/.
ExrImage layered(const Job&, const FrameImage&, const Provenance&);

// One sentence on what stopped the frame and what was achieved.
std::string verdict(const Job&, const FrameImage&);

}  // namespace tessera
