// SPDX-License-Identifier: Apache-2.0
// Weighted means over square windows.
#pragma once

#include <functional>

#include "tests/reference/features.h"

namespace tessera::reference {

// The weight of pixel (qx, qy) in the mean of (x, y).
using Weight = std::function<double(int x, int y, int qx, int qy)>;

// Mean of an AOV about (x, y), over every step-th pixel that is valid. 0 where nothing has a weight.
Rgb window_mean(const Features&, Aov, int x, int y, int radius, int step, const Weight&);

// The colour filtered by such means; invalid pixels keep theirs, what is not finite being 0.
Image of_window(const Features&, int radius, int step, const Weight&);

// exp(-squared / (2 sigma^2))
double gaussian_of(double squared, double sigma);

}  // namespace tessera::reference
