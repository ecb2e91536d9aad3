// SPDX-License-Identifier: Apache-2.0
// What the statistics of a frame are called in files: in ours, and in those of other renderers.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "core/aov.h"
#include "core/exr.h"

namespace tessera {

// Of our files: "noisy.R", "variance.G", "albedo.B", "N_variance.X", "noisy_even.R", "Z", "samples.Y". The
// halves of samples are those of even and of odd index.
std::string file_channel(const Channel&);

// The plane of a file that holds it, or -1: under our name, or under one that Blender, pbrt, Mitsuba and
// Arnold give it, with or without the name of a view layer in front.
int plane_of(const ExrImage& file, const Channel&);

// Of the layer as a whole, for messages: "noisy.RGB (or Noisy Image.RGB, R, G, B)".
std::string accepted_layers(const Channel&);

}  // namespace tessera
