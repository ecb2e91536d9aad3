// SPDX-License-Identifier: Apache-2.0
#include "tests/worker/denoise/inputs.h"

#include <algorithm>
#include <cmath>
#include <random>
#include <stdexcept>

namespace tessera {
namespace {

// What moves. Each frame has a pan of its own, in which the picture also grows: every third one rests. In
// blocks something else happens.
struct Movement {
  int x, y;
  unsigned frame;

  enum class Event { none, other_object, other_depth, other_normal, fast, behind_the_camera };
  Event event() const {
    const auto block = [](int v, int edge) { return static_cast<unsigned>((v + 9000) / edge); };
    const unsigned hash = (block(x, 11) * 2654435761u) ^ (block(y, 7) * 2246822519u) ^ (frame * 3266489917u);
    const unsigned one_of = (hash ^ (hash >> 15)) * 2654435761u >> 28;
    return one_of < 6 ? static_cast<Event>(one_of) : Event::none;
  }
  float motion(int axis) const {
    if (event() == Event::behind_the_camera) return kSkyDepth;
    if (event() == Event::fast) return axis == 0 ? -61.3f + 9 * (y % 4) : 38.7f;
    if (frame % 3 == 0) return 0;
    const float pan =
        axis == 0 ? 1.37f * static_cast<float>(frame % 7) - 3 : 2.6f - 0.83f * static_cast<float>(frame % 5);
    // Every fifth row is seen through water.
    const float wave = y % 5 == 0 ? 0.4f * static_cast<float>((x * 7 + y * 3) % 11 - 5) : 0;
    return pan + 0.013f * static_cast<float>(axis == 0 ? x : y) + wave;
  }
};

struct Pixel {
  int x, y;
  unsigned frame;
  std::string_view kind;
  std::minstd_rand random;

  float uniform() { return std::uniform_real_distribution<float>(0, 1)(random); }
  bool constant() const { return kind == "constant"; }
  // A slanted edge between two surfaces.
  bool near() const { return 3 * x + 7 * y < 300; }

  // Above and below 1.
  float decades() const { return kind == "extreme" ? 30 : kind == "wide" ? 12 : 0; }
  // 0, less than the smallest normal number, or so little that its square is.
  float tiny() {
    const float u = uniform(), v = uniform();
    return v < 0.25f ? 0 : std::pow(10.0f, v < 0.75f ? -38 - 6.5f * u : -19.5f - 5 * u);
  }
  float or_tiny(float v) { return kind == "denormal" && uniform() < 0.25f ? tiny() : v; }

  float light() {
    const float u = uniform(), v = uniform();
    if (constant()) return 0.7f;
    if (const float d = decades(); d > 0) return std::pow(10.0f, 2 * d * u - d);
    if (kind == "denormal" && v < 0.5f) return tiny();
    if (kind == "firefly" && v < 0.01f) return 1e6f * u;
    return (near() ? 1.0f : 0.3f) * u;
  }
  float variance() {
    if (kind == "converged") return 0;
    if (kind == "extreme") return std::pow(10.0f, 40 * uniform() - 30);
    if (kind == "wide") return std::pow(10.0f, 4 * decades() * uniform() - 2 * decades());
    if (kind == "denormal" && uniform() < 0.5f) return tiny();
    return 0.05f * uniform();
  }
  float normal(int i) {
    const float bend = constant() ? 0 : 0.02f * (uniform() - 0.5f);
    const float flat[] = {near() ? 0.6f : 0.0f, 0.0f, near() ? 0.8f : 1.0f};
    return i == 2 ? flat[i] + bend : or_tiny(flat[i] + bend);
  }
  float depth() { return (near() ? 3 + 0.01f * x : 9 - 0.02f * y) + (constant() ? 0 : 0.002f * uniform()); }
  float position(int i) {
    const float z = depth();
    return i == 0 ? 0.001f * z * x : i == 1 ? -0.001f * z * y : -z;
  }
  Movement movement() const { return {x, y, frame}; }
  float previous_depth() {
    const float before_x = static_cast<float>(x) - movement().motion(0);
    const float before_y = static_cast<float>(y) - movement().motion(1);
    const float z = near() ? 3 + 0.01f * before_x : 9 - 0.02f * before_y;
    return movement().event() == Movement::Event::other_depth ? 2 * z : z;
  }
  float geometric_normal(int i) {
    if (movement().event() == Movement::Event::other_normal) return i == 1 ? 1.0f : 0.0f;
    const float flat[] = {near() ? 0.6f : 0.0f, 0.0f, near() ? 0.8f : 1.0f};
    return flat[i];
  }
  float object() {
    if (movement().event() == Movement::Event::other_object) return 100 + static_cast<float>(frame);
    return near() ? 1.0f : 2.0f;
  }
  float depth_gradient(int i) { return near() ? (i == 0 ? 0.01f : 0.0f) : i == 0 ? 0.0f : -0.02f; }
  float samples() { return constant() ? 16.0f : 4.0f + 2.0f * std::floor(6 * uniform()); }
  // A hump over the bins about the light's, so noisy that histograms of one surface now agree and now do not.
  float bin(int i) {
    const float distance = std::abs(static_cast<float>(i) - (near() ? 9.0f : 6.0f));
    const float noise = constant() ? 1 : uniform();
    return distance > 3 ? 0 : (4 - distance) / 5 * noise;
  }
  float sample_value(int i) {
    if (i >= SampleVector::color) return light();
    if (i >= SampleVector::albedo) return near() ? 0.9f * uniform() : 0.25f;
    if (i >= SampleVector::normal2) return normal(i - SampleVector::normal2);
    if (i >= SampleVector::position2) return position(i - SampleVector::position2) + uniform();
    if (i >= SampleVector::normal) return normal(i - SampleVector::normal);
    if (i >= SampleVector::position) return position(i - SampleVector::position);
    if (i == SampleVector::screen) return static_cast<float>(x) + uniform();
    if (i == SampleVector::screen + 1) return static_cast<float>(y) + uniform();
    return uniform();
  }
  float value(const Channel& c) {
    if (c.statistic == Statistic::variance_of_mean) return variance();
    // Over a variance that counts as 0 it would be anything.
    if (c.statistic == Statistic::third_moment && kind == "denormal") return 0;
    if (c.statistic == Statistic::third_moment) return 0.02f * (uniform() - 0.3f);
    if (c.statistic == Statistic::samples) return samples();
    switch (c.aov) {
      case Aov::emission:
        if (kind == "denormal") return 1e-38f * uniform();
        return constant() || decades() > 0 ? 0 : 0.1f * uniform();
      case Aov::albedo:
      case Aov::texture2:
        return constant() ? 0.5f : or_tiny(near() ? 0.9f * uniform() : 0.25f);
      case Aov::normal:
      case Aov::bounce:
        return normal(c.index);
      case Aov::position:
        return position(c.index);
      case Aov::depth:
        return depth();
      case Aov::histogram:
        return bin(c.index % kHistogramBins);
      case Aov::sample_vectors:
        return sample_value(c.index % SampleVector::size);
      // Means that are told apart by variances: of two that differ by nothing, flushed ones say nothing.
      case Aov::box_cox:
        return kind == "denormal" ? uniform() : light();
      case Aov::motion:
        return movement().motion(c.index);
      case Aov::previous_depth:
        return previous_depth();
      case Aov::geometric_normal:
        return geometric_normal(c.index);
      case Aov::object_id:
      case Aov::material_id:
        return object();
      case Aov::depth_gradient:
        return depth_gradient(c.index);
      default:
        return light();
    }
  }
};

}  // namespace

Aov light_of(const FilterPlan& plan) {
  const std::vector<Channel> inputs = plan.inputs();
  const bool color = std::ranges::any_of(
      inputs, [](const Channel& c) { return c.aov == Aov::color && c.statistic == Statistic::mean; });
  return color ? Aov::color : Aov::indirect;
}

int plane_of(const FilterPlan& plan, Aov aov, int index, Statistic statistic) {
  const std::vector<Channel> inputs = plan.inputs();
  for (const Share share : {Share::all, Share::a})
    if (const auto at = std::ranges::find(inputs, Channel{aov, index, statistic, share}); at != inputs.end())
      return static_cast<int>(at - inputs.begin());
  throw std::logic_error(plan.name + " takes no such channel");
}

void put_sky(Image& input, const FilterPlan& plan, int x, int y, float radiance) {
  const std::vector<Channel> inputs = plan.inputs();
  for (int k = 0; k < input.planes(); ++k) {
    const Aov a = inputs[k].aov;
    if (inputs[k].statistic == Statistic::samples) continue;
    if (inputs[k].statistic != Statistic::mean) {
      input.at(k, x, y) = 0;
      continue;
    }
    const bool bright = a == Aov::color || a == Aov::emission;
    const bool far = a == Aov::depth || a == Aov::previous_depth;
    input.at(k, x, y) = bright ? radiance : a == Aov::albedo ? 1.0f : far ? kSkyDepth : 0.0f;
  }
}

Image made_up_input(const FilterPlan& plan, const Region& region, std::string_view kind, unsigned seed) {
  const std::vector<Channel> inputs = plan.inputs();
  Image image(region, static_cast<int>(inputs.size()));
  for (int y = region.y0; y < region.y1; ++y)
    for (int x = region.x0; x < region.x1; ++x) {
      std::minstd_rand random((x + 1000) * 7919u + (y + 1000) * 104729u + seed * 15485863u);
      random.discard(3);
      Pixel pixel{x, y, seed, kind, random};
      for (int k = 0; k < image.planes(); ++k) image.at(k, x, y) = pixel.value(inputs[k]);
      const bool disc = (x - 40) * (x - 40) + (y - 12) * (y - 12) < 80;
      if (kind == "sky" && (disc || pixel.uniform() < 0.05f))
        put_sky(image, plan, x, y, 50 * pixel.uniform());
    }
  return image;
}

}  // namespace tessera
