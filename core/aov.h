// SPDX-License-Identifier: Apache-2.0
// The channel groups a renderer emits, and the planes in which a film sums them.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string_view>
#include <vector>

namespace tessera {

// Reduced over the samples of a pixel; see `Film`. Values are linear and scene-referred. Stable numbers: they
// travel in messages.
enum class Aov : std::uint8_t {
  color = 0,     // radiance, all of it
  direct = 1,    // light that reached the first hit straight from an emitter, reflected there (no emission)
  indirect = 2,  // light that reached the first hit after another bounce
  emission = 3,  // emission of the first hit, and the environment behind everything; color = 1 + 2 + 3
  albedo = 4,    // hemispherical reflectance of the first hit; sky 1
  normal = 5,    // shading normal of the first hit, world space, facing the camera; sky (0, 0, 0)
  position = 6,  // world-space first hit; sky: camera + scene diameter * direction
  depth = 7,  // along the view axis, world units, averaged over the samples that hit; kSkyDepth if none did
};
inline constexpr int kAovs = 8;

inline constexpr float kSkyDepth = 1e30f;

struct AovInfo {
  Aov aov;
  std::string_view name;      // layer name in EXR files; color is the bare R,G,B
  std::string_view channels;  // one letter per channel: RGB, XYZ or Z
  bool squares;               // squares are summed too, so that a variance is known
};
const AovInfo& info(Aov);

// A set of AOVs. The sample counts and the coverage (alpha) of a pixel are always kept.
class AovSet {
 public:
  constexpr AovSet() = default;
  constexpr AovSet(std::initializer_list<Aov> aovs) {
    for (Aov a : aovs) bits_ |= bit(a);
  }
  static constexpr AovSet from_bits(std::uint32_t bits) {
    AovSet set;
    set.bits_ = bits;
    return set;
  }
  constexpr bool has(Aov a) const { return (bits_ & bit(a)) != 0; }
  constexpr std::uint32_t bits() const { return bits_; }
  constexpr AovSet operator|(AovSet o) const { return from_bits(bits_ | o.bits_); }
  constexpr bool operator==(const AovSet&) const = default;

 private:
  static constexpr std::uint32_t bit(Aov a) { return 1u << static_cast<unsigned>(a); }
  std::uint32_t bits_ = 0;
};

// Even sample indices of a pixel are half A, odd ones half B: independent scrambles, so independent
// estimates.
enum class Half : std::uint8_t { a = 0, b = 1 };

// Where each sum of a film or block lies, for one set of AOVs: planes come in pairs (half A, half B).
//   0,1 valid samples   2,3 samples whose primary ray hit something   then, AOV by AOV: sums of each channel
//   and, where info(aov).squares, sums of squares of each channel.
class FilmLayout {
 public:
  explicit FilmLayout(AovSet aovs);

  AovSet aovs() const { return aovs_; }
  int planes() const { return planes_; }
  static int count(Half h) { return 0 + static_cast<int>(h); }
  static int hits(Half h) { return 2 + static_cast<int>(h); }
  // Precondition: the AOV is in the set (and has squares).
  int sum(Aov a, int channel, Half h) const { return first_[int(a)] + 2 * channel + static_cast<int>(h); }
  int square(Aov a, int channel, Half h) const;

 private:
  AovSet aovs_;
  int first_[kAovs] = {};
  int planes_ = 0;
};

// One plane that a filter or a file wants from a film.
enum class Statistic : std::uint8_t {
  mean,              // of the valid samples; depth: of the hits. 0 where there is no sample
  variance_of_mean,  // unbiased sample variance / n, never negative; 0 where n < 2
};
struct Channel {
  Aov aov = Aov::color;
  int index = 0;
  Statistic statistic = Statistic::mean;
  bool operator==(const Channel&) const = default;
};

// The three (or one) mean channels of an AOV.
std::vector<Channel> channels_of(Aov, Statistic = Statistic::mean);

AovSet aovs_of(const std::vector<Channel>&);

}  // namespace tessera
