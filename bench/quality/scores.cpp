// SPDX-License-Identifier: Apache-2.0
#include "bench/quality/scores.h"

#include <fmt/format.h>

#include "core/quality/display.h"
#include "core/quality/flip.h"
#include "core/quality/luv.h"
#include "core/quality/metrics.h"
#include "core/quality/ssim.h"

namespace tessera::quality {

void score(const Image& image, const Image& reference, const Image& variance, Scores& scores) {
  double noise = 0;
  for (std::size_t i = 0; i < reference.data().size(); ++i) {
    const double r = reference.data()[i];
    noise += variance.data()[i] / (r * r + kRelMseEpsilon);
  }
  scores.relmse = rel_mse(image, reference) - noise / static_cast<double>(reference.data().size());
  scores.relmse_trimmed = rel_mse_trimmed(image, reference);
  const Display as_the_papers{Curve::gamma, 0};
  const Image x = displayed(image, as_the_papers), r = displayed(reference, as_the_papers);
  scores.rmse = rmse(x, r);
  scores.mse0 = 3 * mse(x, r);
  scores.ssim = ssim(x, r);
  const Image light_x = screen_light(image, as_the_papers), light_r = screen_light(reference, as_the_papers);
  static const FlipKernels kernels = flip_kernels(kPixelsPerDegree);
  scores.flip = mean(flip_map(light_x, light_r, kernels));
  scores.lightness = mean(lightness_error_map(light_x, light_r));
  scores.luv = mean(luv_error_map(light_x, light_r));
}

std::string csv(const std::vector<Scores>& all) {
  std::string text =
      "scene,samples,filter,ms,relmse,relmse_trimmed,rmse_display,mse0_display,ssim,flip,cieluv_l,cieluv\n";
  for (const Scores& s : all)
    text += fmt::format("{},{},\"{}\",{:.2f},{:.6e},{:.6e},{:.6e},{:.6e},{:.5f},{:.5f},{:.4f},{:.4f}\n",
                        s.scene, s.samples, s.filter, s.milliseconds, s.relmse, s.relmse_trimmed, s.rmse,
                        s.mse0, s.ssim, s.flip, s.lightness, s.luv);
  return text;
}

}  // namespace tessera::quality
