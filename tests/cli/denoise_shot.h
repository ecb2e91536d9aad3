// SPDX-License-Identifier: Apache-2.0
// A made-up shot for `tessera denoise`: a lit wall that slides through the picture.
#pragma once

#include <algorithm>
#include <cmath>
#include <initializer_list>
#include <random>
#include <string>
#include <vector>

#include "core/filter/filter.h"
#include "core/layers.h"
#include "tests/cli/denoise_fixture.h"

namespace tessera {

inline constexpr Region kRegion{0, 0, 40, 24};
inline constexpr float kPace = 2;  // pixels to the right a frame

class DenoiseShot : public DenoiseFixture {
 protected:
  // Of a lit wall that slides through the picture; what is new is the noise.
  ExrImage picture(int number, const Region& region = kRegion) const {
    ExrImage image;
    image.display = region;
    std::vector<Channel> channels = parse_filter("svgf:history=on").inputs();
    for (const Aov a : {Aov::next_motion, Aov::next_depth})
      for (const Channel& c : channels_of(a)) channels.push_back(c);
    image.pixels = Image(region, static_cast<int>(channels.size()) + 3, 0.5f);
    std::minstd_rand random(static_cast<unsigned>(number) + 1);
    std::normal_distribution<float> noise(0, 0.2f);
    for (std::size_t k = 0; k < channels.size(); ++k) {
      const Channel& c = channels[k];
      image.channels.push_back({file_channel(c), ExrType::float32});
      for (float& v : image.pixels.plane(static_cast<int>(k))) v = value(c, noise(random));
    }
    for (const char* name : {"R", "G", "B"}) image.channels.push_back({name, ExrType::float32});
    return image;
  }
  static float value(const Channel& c, float noise) {
    if (c.statistic == Statistic::variance_of_mean) return 0.04f;
    switch (c.aov) {
      case Aov::direct:
      case Aov::indirect:
        return 1 + noise;
      case Aov::albedo:
        return 0.5f;
      case Aov::normal:
      case Aov::geometric_normal:
        return c.index == 2 ? 1 : 0;
      case Aov::depth:
      case Aov::previous_depth:
      case Aov::next_depth:
        return 5;
      case Aov::motion:
      case Aov::next_motion:
        return c.index == 0 ? kPace : 0;
      case Aov::object_id:
        return 1;
      default:
        return 0;
    }
  }
  static std::string name(const std::string& stem, int number) {
    return stem + ".000" + std::to_string(number) + ".exr";
  }
  void write_shot(std::initializer_list<int> numbers) const {
    for (const int f : numbers) write(name("in", f), picture(f));
  }
  DenoiseOptions shot(const std::string& out) const {
    DenoiseOptions o = options("in.####.exr", out + ".####.exr");
    o.filter = "svgf:levels=1,history=on";
    return o;
  }
  Image rgb(const std::string& stem, int number) const {
    const ExrImage file = read_exr(path(name(stem, number)));
    Image picture(file.pixels.region(), 3);
    for (int c = 0; c < 3; ++c)
      std::ranges::copy(file.pixels.plane(file.plane(std::string(1, "RGB"[c]))), picture.plane(c).begin());
    return picture;
  }
  bool there(const std::string& stem, int number) const {
    return std::filesystem::exists(path(name(stem, number)));
  }
  // The frame alone.
  Image single(int number) {
    DenoiseOptions o = options(name("in", number), "single.000" + std::to_string(number) + ".exr");
    o.filter = shot("").filter;
    EXPECT_EQ(run(o), 0);
    return rgb("single", number);
  }
  static double noise_of(const Image& picture) {
    double sum = 0;
    for (const float v : picture.data()) sum += (v - 2.0) * (v - 2.0);  // 1 of direct, 1 of indirect light
    return std::sqrt(sum / static_cast<double>(picture.data().size()));
  }
  static double difference(const Image& a, const Image& b) {
    double most = 0;
    for (std::size_t i = 0; i < a.data().size(); ++i)
      most = std::max(most, std::abs(double(a.data()[i]) - b.data()[i]));
    return most;
  }
};

}  // namespace tessera
