// SPDX-License-Identifier: Apache-2.0
// How a filter ends with temporal anti-aliasing, or without. Its program lists kernels/taa.cl.
#pragma once

#include "worker/denoise/stage.h"

namespace tessera {

// Where a filter's last kernel writes RGB: plane after plane over `region`. That is the stage's output over
// inner(), or what taa() then reads.
struct Picture {
  Region region;
  cl::Buffer buffer;
};
Picture picture(Stage&);

// Where the plan says taa=on, the stage's output from the picture, and its last planes of history.
void taa(Stage&, const Picture&);

}  // namespace tessera
