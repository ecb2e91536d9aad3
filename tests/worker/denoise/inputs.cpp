// SPDX-License-Identifier: Apache-2.0
#include "tests/worker/denoise/inputs.h"

#include <algorithm>
#include <cmath>
#include <random>

namespace tessera {
namespace {

struct Pixel {
  int x, y;
  std::string_view kind;
  std::minstd_rand random;

  float uniform() { return std::uniform_real_distribution<float>(0, 1)(random); }
  bool constant() const { return kind == "constant"; }
  // A slanted edge between two surfaces.
  bool near() const { return 3 * x + 7 * y < 300; }

  float light() {
    const float u = uniform(), v = uniform();
    if (constant()) return 0.7f;
    if (kind == "extreme") return std::pow(10.0f, 60 * u - 30);
    if (kind == "firefly" && v < 0.01f) return 1e6f * u;
    return (near() ? 1.0f : 0.3f) * u;
  }
  float variance() {
    if (kind == "converged") return 0;
    if (kind == "extreme") return std::pow(10.0f, 40 * uniform() - 30);
    return 0.05f * uniform();
  }
  float normal(int i) {
    const float bend = constant() ? 0 : 0.02f * (uniform() - 0.5f);
    const float flat[] = {near() ? 0.6f : 0.0f, 0.0f, near() ? 0.8f : 1.0f};
    return flat[i] + bend;
  }
  float depth() { return (near() ? 3 + 0.01f * x : 9 - 0.02f * y) + (constant() ? 0 : 0.002f * uniform()); }
  float position(int i) {
    const float z = depth();
    return i == 0 ? 0.001f * z * x : i == 1 ? -0.001f * z * y : -z;
  }
  float value(const Channel& c) {
    if (c.statistic == Statistic::variance_of_mean) return variance();
    switch (c.aov) {
      case Aov::emission:
        return constant() || kind == "extreme" ? 0 : 0.1f * uniform();
      case Aov::albedo:
        return constant() ? 0.5f : near() ? 0.9f * uniform() : 0.25f;
      case Aov::normal:
        return normal(c.index);
      case Aov::position:
        return position(c.index);
      case Aov::depth:
        return depth();
      default:
        return light();
    }
  }
};

}  // namespace

int plane_of(const FilterPlan& plan, Aov aov, int index, Statistic statistic) {
  const auto& inputs = plan.description().inputs;
  return static_cast<int>(std::ranges::find(inputs, Channel{aov, index, statistic}) - inputs.begin());
}

void put_sky(Image& input, const FilterPlan& plan, int x, int y, float radiance) {
  const auto& inputs = plan.description().inputs;
  for (int k = 0; k < input.planes(); ++k) {
    const Aov a = inputs[k].aov;
    const bool bright = a == Aov::color || a == Aov::emission;
    input.at(k, x, y) = bright ? radiance : a == Aov::albedo ? 1.0f : a == Aov::depth ? kSkyDepth : 0.0f;
  }
}

Image made_up_input(const FilterPlan& plan, const Region& region, std::string_view kind, unsigned seed) {
  const auto& inputs = plan.description().inputs;
  Image image(region, static_cast<int>(inputs.size()));
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x) {
      std::minstd_rand random((x + 1000) * 7919u + (y + 1000) * 104729u + seed * 15485863u);
      random.discard(3);
      Pixel pixel{x, y, kind, random};
      for (int k = 0; k < image.planes(); ++k) image.at(k, x, y) = pixel.value(inputs[k]);
      const bool disc = (x - 40) * (x - 40) + (y - 12) * (y - 12) < 80;
      if (kind == "sky" && (disc || pixel.uniform() < 0.05f))
        put_sky(image, plan, x, y, 50 * pixel.uniform());
    }
  return image;
}

}  // namespace tessera
