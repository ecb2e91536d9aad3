// SPDX-License-Identifier: Apache-2.0
#include "bench/temporal/scores.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/quality/display.h"
#include "core/quality/metrics.h"
#include "core/quality/ssim.h"

namespace tessera::temporal {
namespace {

double mean_product(const Image& x, const Image& a, const Image& b) {
  double sum = 0;
  for (std::size_t i = 0; i < x.data().size(); ++i)
    sum += (double{x.data()[i]} - a.data()[i]) * (double{x.data()[i]} - b.data()[i]);
  return sum / static_cast<double>(x.data().size());
}

}  // namespace

void score(const Image& image, const judging::Reference& reference, TemporalError& stability,
           FrameScores& scores) {
  const Display as_the_papers{Curve::gamma, 0};
  Image x = displayed(image, as_the_papers), r = displayed(reference.mean, as_the_papers);
  const Image a = displayed(reference.a, as_the_papers), b = displayed(reference.b, as_the_papers);
  scores.rmse = std::sqrt(std::max(0.0, mean_product(x, a, b)));
  scores.reference_noise = rmse(a, b) / 2;
  scores.ssim = ssim(x, r);
  if (const auto step = stability.add(std::move(x), std::move(r))) {
    scores.error = step->error;
    scores.reference_error = step->reference_error;
    scores.residual = step->residual;
  }
}

std::string frames_csv(const Results& results) {
  std::string text =
      "scene,group,filter,frame,rmse_display,ssim,temporal_error,temporal_error_reference,residual,"
      "reference_noise,kernel_ms\n";
  for (const FrameScores& s : results.frames_scores)
    text += fmt::format("{},{},\"{}\",{},{:.6f},{:.5f},{:.6f},{:.6f},{:.6f},{:.6f},{:.3f}\n", s.scene,
                        s.group, s.filter, s.frame, s.rmse, s.ssim, s.error, s.reference_error, s.residual,
                        s.reference_noise, s.milliseconds);
  return text;
}

std::string kernels_csv(const Results& results) {
  std::string text = "scene,filter,kernel,ms\n";
  for (const KernelScores& k : results.kernels)
    text += fmt::format("{},\"{}\",{},{:.4f}\n", k.scene, k.filter, k.kernel, k.milliseconds);
  return text;
}

}  // namespace tessera::temporal
