// SPDX-License-Identifier: Apache-2.0
// LDR-FLIP: how much of a difference someone sees who flips between two pictures (Andersson, Nilsson,
// Akenine-Moller, Oskarsson, Astrom, Fairchild 2020, "FLIP: A Difference Evaluator for Alternating Images").
#pragma once

#include <vector>

#include "core/quality/error_map.h"

namespace tessera {

// What an eye sees of a screen's pixels: of a screen 0.7 m wide with 3840 pixels in a row, from 0.7 m.
constexpr double pixels_per_degree(double distance, double width, double pixels) {
  return distance * pixels / width * 3.14159265358979323846 / 180;
}
inline constexpr double kPixelsPerDegree = pixels_per_degree(0.7, 0.7, 3840);

// One-dimensional; the two-dimensional kernels are products of them, see flip.cpp.
struct FlipKernels {
  // The eye's contrast sensitivity, sums 1. That of blue-yellow is a sum of two Gaussians, of which the first
  // has that share.
  std::vector<double> achromatic, red_green, blue_yellow[2];
  double blue_yellow_share = 0;
  // First and second derivative of a Gaussian, positive parts of sum 1, negative ones of sum -1; and along
  // the other direction the Gaussian itself, sum 1.
  std::vector<double> edge, point, smooth;
};
FlipKernels flip_kernels(double pixels_per_degree);

// FLIP per pixel, 0 to 1. Takes linear RGB as a screen shows it; beyond 0..1 it is clipped.
ErrorMap flip_map(const Image& x, const Image& r, const FlipKernels&);

}  // namespace tessera
