// SPDX-License-Identifier: Apache-2.0
// Windows of which every tap has a weight of its own: their strips (kernels/window.cl) as seen from the host.
// Internal to worker/denoise.
#pragma once

#include "worker/denoise/stage.h"

namespace tessera {

// For the kernel compiler. The window is the plan's first pass.
std::string window_options(const FilterPlan&, int planes);

// What the window over the inner region reads: its strips, and the regions that its two kernels run over.
struct Window {
  Planes strips;
  Region to_prepare, to_filter;  // as high as there are work-items
};
Window window(Stage&, int planes);
// Of its strips.
std::size_t window_floats(Size filtered, int radius, int planes);

// Weights' exponents of one octave, as the kernels count them.
inline constexpr double kOctave = 1 << 23;

// What a weight exp(-x^2 / sigma^2) has taken off its exponent for each x^2.
float exponent_over_square(double sigma);

// By what a plane is multiplied so that squared differences are what a Gaussian of this sigma takes off a
// weight's exponent.
float gaussian_scale(double sigma);
// The same for depth, whose sigma is in tenths of the scene's diameter.
float depth_scale(const FilterPlan&, double sigma);

}  // namespace tessera
