// SPDX-License-Identifier: Apache-2.0
// The error of a denoised image, estimated without a reference, cell by cell. Pure, and the same bits however
// the frame was cut: every sum runs in the order of the global pixel grid.
//
// With independent halves A, B of the samples and the filter run on each (X_A, X_B), Y = (X_A + X_B) / 2 has
//   T = (A - X_A)(B - X_B) + (X_A - X_B)^2 / 4,    E[T] = MSE(Y)
// for any filter: E[(A - X_A)(B - X_B)] = bias^2 as A and B are independent, Var(Y) = E (X_A - X_B)^2 / 4.
// With fresh samples C1, C2 that took no part in the delivered image D, the hold-out estimate is
//   H = (D - C1)(D - C2),    E[H | D] = (D - mu)^2.
// (Both after the products of independent copies of Marcos-Morales et al. 2023.)
#pragma once

#include <vector>

#include "core/image.h"
#include "core/quality/metrics.h"

namespace tessera {

struct ErrorEstimate {
  double mean = 0;            // relMSE; may be negative by chance
  double standard_error = 0;  // block jackknife, see estimate.cpp; mean + 1.645 of it bounds 95 %
  double upper(double z) const { return mean + z * standard_error; }
  bool operator==(const ErrorEstimate&) const = default;
};

// Planes 0..2: linear RGB. All images cover `cell`.
struct HalfImages {
  const Image& a;  // noisy halves, means
  const Image& b;
  const Image& x_a;  // filtered halves
  const Image& x_b;
};

inline constexpr int kWeightRadius = 4;

// 1 / (r^2 + epsilon) per pixel and channel over `cell`, where r stands for the reference: see estimate.cpp
// for the choice. `y` covers `cell` and kWeightRadius pixels around it, as far as the frame reaches; what it
// covers beyond that changes nothing but at the frame's edge, so cut it to the frame.
Image relative_weight(const Image& y, const Region& cell);

// A value that is not finite makes the estimate infinite, so it is never accepted.
ErrorEstimate estimate_from_halves(const HalfImages&, const Image& weight, const Region& cell);
ErrorEstimate estimate_from_hold_out(const Image& delivered, const Image& c1, const Image& c2,
                                     const Image& weight, const Region& cell);

// The mean over the pixels of several regions, `areas` in pixels, whose estimates are taken as independent.
ErrorEstimate pooled(const std::vector<ErrorEstimate>&, const std::vector<double>& areas);

}  // namespace tessera
