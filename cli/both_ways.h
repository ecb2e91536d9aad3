// SPDX-License-Identifier: Apache-2.0
// A frame filtered in both directions of time.
#pragma once

#include "core/image.h"

namespace tessera {

// RGB. Each way has this frame in it, and lags behind what changes, but in opposite directions: equal weights
// let that cancel, however much of the noise either way has lost.
inline Image mean_of_ways(const Image& forwards, const Image& backwards) {
  Image mean = forwards;
  for (std::size_t i = 0; i < mean.data().size(); ++i)
    mean.data()[i] += (backwards.data()[i] - mean.data()[i]) / 2;
  return mean;
}

}  // namespace tessera
