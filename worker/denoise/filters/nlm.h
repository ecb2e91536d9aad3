// SPDX-License-Identifier: Apache-2.0
// Runs of the kernels nlm and nlm_mean_of_exp, for all filters that use non-local means. Internal to
// worker/denoise.
#pragma once

#include "core/filter/nlm.h"
#include "worker/denoise/stage.h"
#include "worker/denoise/tiles.h"

namespace tessera {

struct NlmTuning {
  double k = 0.45, alpha = 1, threshold = 0.05, epsilon = 1e-10;
};

// Macros of kernels/nlm_common.cl and those behind it.
std::string nlm_options(const NlmShape&, bool soft = false);

// What multiplies the variance that a signal of run() carries, and what is added to it.
cl_float2 nlm_variance(const NlmTuning&);

// Filters signals over `over`; what it takes of scratch is nlm_scratch(). What the planes hold is said in the
// kernels' files; signals and results begin at the planes `first` and `first_to`.
class Nlm {
 public:
  Nlm(Stage&, const Region& over, const NlmShape&);
  // kernels/nlm.cl: of either half all channels.
  void run(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to,
           const NlmTuning&);
  // kernels/nlm_prefilter.cl: one plane.
  void mean_of_exp(const Planes& valid, const Planes& signals, int first, const Planes& to, int first_to);

 private:
  Stage& stage_;
  Region over_;
  NlmShape shape_;
  Tiles tiles_;
  int room_;
  Planes scratch_;
};

}  // namespace tessera
