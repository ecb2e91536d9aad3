// SPDX-License-Identifier: Apache-2.0
// How a sequence of frames flickers, frame by frame as they come, on values as displayed. L is Rec. 709 luma.
#pragma once

#include <optional>

#include "core/image.h"

namespace tessera {

// Of a frame x_t and its reference r_t, means over the pixels of L of the absolute differences per channel.
struct TemporalStep {
  double error = 0;            // |x_t - x_(t-1)|
  double reference_error = 0;  // |r_t - r_(t-1)|: what moves in the scene
  double residual = 0;         // |(x_t - x_(t-1)) - (r_t - r_(t-1))|: 0 for a perfect sequence
};

// Mean and spread of each value over the frames, one after the other (Welford 1962).
class FrameSpread {
 public:
  void add(const Image& frame);
  // Mean over the pixels of L of the standard deviation over the frames (of n - 1); NaN for less than two.
  double deviation() const;

 private:
  int frames_ = 0;
  Image mean_, square_;
};

class TemporalError {
 public:
  // Frames in order, of one region. None for the first.
  std::optional<TemporalStep> add(Image x, Image r);
  // Spread of the image and of the reference: noise, if the scene is static.
  double deviation() const { return x_spread_.deviation(); }
  double reference_deviation() const { return r_spread_.deviation(); }
  // |TE(x) - TE(r)| / TE(r) with the errors averaged over the frames. NaN for one frame; infinite, or NaN for
  // an image that does not change either, if the reference does not change.
  double relative_error() const;

 private:
  Image x_, r_;  // the frame before
  FrameSpread x_spread_, r_spread_;
  double error_ = 0, reference_error_ = 0;  // sums
};

}  // namespace tessera
