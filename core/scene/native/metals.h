// SPDX-License-Identifier: Apache-2.0
// The optical constants of metals, by name: refractive index and extinction at 630, 532 and 465 nm (for red,
// green and blue), linear between the two nearest wavelengths of the tables in
// - Johnson and Christy, Optical Constants of the Noble Metals, Phys. Rev. B 6, 4370 (1972): Cu, Au, Ag;
// - Johnson and Christy, Optical constants of transition metals, Phys. Rev. B 9, 5056 (1974): Cr, Fe, Ni, Ti;
// - Rakic et al., Optical properties of metallic films, Appl. Opt. 37, 5271 (1998), the fit to the
//   Brendel-Bormann model: Al;
// and for brass, an alloy without one composition, numbers in common use.
#pragma once

#include <array>
#include <string_view>
#include <utility>

#include "core/scene/scene.h"

namespace tessera {

struct Metal {
  Color eta, k;
};

inline const std::array<std::pair<std::string_view, Metal>, 9> kMetals{
    {{"aluminium", {{1.255f, 0.902f, 0.667f}, {7.250f, 6.210f, 5.475f}}},
     {"brass", {{0.44f, 0.53f, 1.09f}, {3.70f, 2.77f, 1.83f}}},
     {"chromium", {{3.145f, 3.034f, 2.456f}, {3.312f, 3.330f, 3.210f}}},
     {"copper", {{0.275f, 1.116f, 1.247f}, {3.373f, 2.596f, 2.456f}}},
     {"gold", {{0.188f, 0.544f, 1.332f}, {3.403f, 2.231f, 1.869f}}},
     {"iron", {{2.892f, 2.895f, 2.646f}, {3.065f, 2.918f, 2.805f}}},
     {"nickel", {{1.990f, 1.877f, 1.765f}, {4.094f, 3.495f, 3.048f}}},
     {"silver", {{0.057f, 0.054f, 0.047f}, {4.254f, 3.429f, 2.803f}}},
     {"titanium", {{2.698f, 2.479f, 2.305f}, {3.757f, 3.351f, 3.082f}}}}};

}  // namespace tessera
