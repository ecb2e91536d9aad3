// SPDX-License-Identifier: Apache-2.0
// What the statistics of a frame are called in files: in ours, and in those of other renderers.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "core/aov.h"
#include "core/exr.h"

namespace tessera {

// Of our files: "noisy.R", "variance.G", "albedo.B", "N_variance.X", "noisy_even.R", "Z", "samples.Y". The
// halves of samples are those of even and of odd index.
std::string file_channel(const Channel&);

struct FilePlane {
  int number = 0;
  float scale = 1;  // what its values are to be multiplied by
  bool operator==(const FilePlane&) const = default;
};

// The plane of a file that holds it: under our name, or under one that Blender, pbrt, Mitsuba and Arnold give
// it, with or without the name of a view layer in front.
std::optional<FilePlane> find_plane(const ExrImage& file, const Channel&);

// The same in a file of that layer alone, in which channels may go by their letters: the normal is N.X, Y, or R, G, B.
std::optional<FilePlane> find_plane_alone(const ExrImage& file, const Channel&);

// pbrt's variance, which is that of a single sample: that of the mean times the samples of the pixel. Found only for
// the variance of Aov::color.
std::optional<FilePlane> find_variance_of_samples(const ExrImage& file, const Channel&);

// Motion as renderers write it whose unit depends on their settings or is not written down: Arnold's,
// Redshift's and V-Ray's. Found only for Aov::motion.
std::optional<FilePlane> find_motion_of_unknown_unit(const ExrImage& file, const Channel&);

// "albedo", "N_variance", "Z", "samples": what is before the letters of file_channel().
std::string layer_of(const Channel&);
// Of all that a filter may take.
std::vector<std::string> layer_names();

// Of the layer as a whole, for messages: "noisy.RGB (or Noisy Image.RGB, R, G, B)".
std::string accepted_layers(const Channel&);

}  // namespace tessera
