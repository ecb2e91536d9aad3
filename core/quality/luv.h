// SPDX-License-Identifier: Apache-2.0
// Squared distances in CIE 1976 L*u*v* (D65), of the light that a screen sends out.
#pragma once

#include "core/quality/error_map.h"

namespace tessera {

// Per pixel (dL*)^2 + (du*)^2 + (dv*)^2, or the first alone. Takes linear RGB, black 0 to white 1.
ErrorMap luv_error_map(const Image& x, const Image& r);
ErrorMap lightness_error_map(const Image& x, const Image& r);

}  // namespace tessera
