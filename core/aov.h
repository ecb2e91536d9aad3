// SPDX-License-Identifier: Apache-2.0
// The channel groups a renderer emits, and the planes in which a film sums them.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

// Reduced over the samples of a pixel; see `Film`. Values are linear and scene-referred. Stable numbers: they
// travel in messages.
enum class Aov : std::uint8_t {
  color = 0,     // radiance, all of it
  direct = 1,    // light that reached the first hit straight from an emitter, reflected there (no emission)
  indirect = 2,  // light that reached the first hit after another bounce
  emission = 3,  // emission of the first hit, and the background behind everything; color = 1 + 2 + 3
  albedo = 4,    // hemispherical reflectance of the first hit; sky 1
  normal = 5,    // shading normal of the first hit, world space, facing the camera; sky (0, 0, 0)
  position = 6,  // world-space first hit; sky: camera + scene diameter * direction
  depth = 7,  // along the view axis, world units, averaged over the samples that hit; kSkyDepth if none did
  texture2 = 8,  // albedo of the first diffuse surface after the first hit, through mirrors and glass; else 0
                 // (the Data Driven Filter of van de Vlasakker 2013)
  bounce = 9,    // unit direction in which the path left the first hit; 0 if it ended there
  shading = 10,  // mean over the path's vertices of the luminance that emitters sent there, seen and weighed
                 // as in multiple importance sampling, without what surfaces made of it (the feature of the
                 // Feature Distance Filter)
  histogram = 11,         // of the color, per channel: see histogram_bin()
  box_cox = 12,           // 2 (sqrt(color) - 1): Box and Cox's transform, lambda 1/2, as in Sakai et al. 2024
  guide_squares = 13,     // no channels of its own: albedo, normal, position and depth sum their squares too
  motion = 14,            // pixels from where the surface was seen one frame before to where it is now
  previous_depth = 15,    // view depth of that surface point one frame before; kSkyDepth for sky
  geometric_normal = 16,  // unit, world space, facing the camera; sky (0, 0, 0)
  object_id = 17,         // index into Scene::objects plus 1; 0: sky or nameless
  material_id = 18,       // index into Scene::materials plus 1; 0: sky
  depth_gradient = 19,    // change of the view depth per pixel to the right and down; sky 0
  object_matte = 20,      // which objects cover the pixel: Cryptomatte ranks
  material_matte = 21,
  sample_vectors = 22,  // what Random Parameter Filtering wants of each of the first kLeafSamples samples:
                        // see SampleVector
  light_group = 24,     // and 25 to 31: light of group 0 to 7, of all bounces
  next_motion = 32,     // pixels from where the surface is now to where it will be seen one frame later
  next_depth = 33,      // view depth of that surface point one frame later; kSkyDepth for sky
};
inline constexpr int kAovs = 34;

inline constexpr float kSkyDepth = 1e30f;

// What the planes of an AOV are sums of.
enum class Reduction : std::uint8_t {
  mean,        // values of all samples
  point,       // one value, from a ray through the pixel's centre without lens, at the middle of the shutter
  ranks,       // (id, how many samples) pairs, most frequent first: merged, never added
  per_sample,  // values of single samples, each in planes of its own
};

struct AovInfo {
  Aov aov;
  std::string_view name;     // as users ask for it, and the layer in EXR files; color is the bare R,G,B
  std::string_view letters;  // of its channels: RGB, XYZ, ...; empty: numbered
  int channels;
  int moments;  // sums of the powers 1 to `moments` of each channel are kept
  Reduction reduction;
};
const AovInfo& info(Aov);
// The channel's name in its layer.
std::string channel_name(Aov, int channel);
// Number 23 is nobody's.
constexpr bool is_aov(int number) { return number >= 0 && number < kAovs && number != 23; }
constexpr bool is_light_group(int number) { return number >= 24 && number < 32; }
constexpr Aov light_group_aov(int group) {
  return static_cast<Aov>(static_cast<int>(Aov::light_group) + group);
}

// Bins of Ray Histogram Fusion: 20 a channel, from 0 to 7.5, widths growing with exponent 2.2; what is
// brighter is in the last one.
inline constexpr int kHistogramBins = 20;
int histogram_bin(float value);

// The parts of the 26 numbers of a sample (Sen and Darabi 2012, "On Filtering the Noise from the Random
// Parameters in Monte Carlo Rendering"; the choice of van de Vlasakker 2013).
struct SampleVector {
  static constexpr int screen = 0;      // x, y in pixels of the frame
  static constexpr int lens = 2;        // two random numbers, 0..1
  static constexpr int time = 4;        // 0..1 while the shutter is open
  static constexpr int bounce = 5;      // x, y, z, as Aov::bounce
  static constexpr int position = 8;    // first hit, world
  static constexpr int normal = 11;     // first hit
  static constexpr int position2 = 14;  // second hit; 0 if there is none
  static constexpr int normal2 = 17;    // (0, 0, 0) if there is none: which tells
  static constexpr int albedo = 20;     // first hit
  static constexpr int color = 23;
  static constexpr int size = 26;
};

// Cryptomatte ranks that are kept of a pixel half.
inline constexpr int kMatteRanks = 6;

// A set of AOVs. The sample counts and the coverage (alpha) of a pixel are always kept.
class AovSet {
 public:
  constexpr AovSet() = default;
  constexpr AovSet(std::initializer_list<Aov> aovs) {
    for (Aov a : aovs) bits_ |= bit(a);
  }
  static constexpr AovSet from_bits(std::uint64_t bits) {
    AovSet set;
    set.bits_ = bits;
    return set;
  }
  static constexpr AovSet all() {
    AovSet set;
    for (int i = 0; i < kAovs; ++i)
      if (is_aov(i)) set.bits_ |= bit(static_cast<Aov>(i));
    return set;
  }
  constexpr bool has(Aov a) const { return (bits_ & bit(a)) != 0; }
  constexpr std::uint64_t bits() const { return bits_; }
  constexpr AovSet operator|(AovSet o) const { return from_bits(bits_ | o.bits_); }
  constexpr bool operator==(const AovSet&) const = default;

 private:
  static constexpr std::uint64_t bit(Aov a) { return std::uint64_t{1} << static_cast<unsigned>(a); }
  std::uint64_t bits_ = 0;
};

// Even sample indices of a pixel are half A, odd ones half B: independent scrambles, so independent
// estimates.
enum class Half : std::uint8_t { a = 0, b = 1 };

// Where each sum of a film or block lies, for one set of AOVs: planes come in pairs (half A, half B).
//   0,1 valid samples   2,3 samples whose primary ray hit something   then, AOV by AOV: sums of each channel,
//   then sums of squares of each channel, and so on for each moment.
class FilmLayout {
 public:
  explicit FilmLayout(AovSet aovs);

  AovSet aovs() const { return aovs_; }
  int planes() const { return planes_; }
  static int count(Half h) { return 0 + static_cast<int>(h); }
  static int hits(Half h) { return 2 + static_cast<int>(h); }
  // How many powers of each channel of the AOV are summed.
  int moments(Aov) const;
  // Of the channel's `power`-th powers. Precondition: the AOV is in the set, and has that moment.
  int sum(Aov, int channel, Half, int power = 1) const;
  int square(Aov a, int channel, Half h) const { return sum(a, channel, h, 2); }
  // The planes here of what lies in those of `part`, in its order. Precondition: all of it is here.
  std::vector<int> planes_of(const FilmLayout& part) const;

  // The planes of lists of ranks: of half A, and of half B one further. Each list has 2 * kMatteRanks planes,
  // every second one from its first.
  const std::vector<int>& rank_lists() const { return rank_lists_; }

 private:
  AovSet aovs_;
  int first_[kAovs] = {};
  int planes_ = 0;
  std::vector<int> rank_lists_;
};

// One plane that a filter or a file wants from a film.
enum class Statistic : std::uint8_t {
  mean,  // of the valid samples; depth: of the hits. 0 where there is no sample. Point AOVs: the value
  variance_of_mean,  // unbiased sample variance / n, never negative; 0 where n < 2
  third_moment,      // mean of the cubed distances from the mean; 0 where there is no sample
  samples,           // how many valid ones there are, whatever the AOV
};
// Of which samples: all of the part that is developed, or one half of them. A half has no halves of its own:
// there, both are the half itself, and a filter that compares halves compares it with itself.
enum class Share : std::uint8_t { all, a, b };
struct Channel {
  Aov aov = Aov::color;
  int index = 0;
  Statistic statistic = Statistic::mean;
  Share share = Share::all;
  bool operator==(const Channel&) const = default;
};
inline constexpr Channel kSampleCount{Aov::color, 0, Statistic::samples};

// All channels of an AOV.
std::vector<Channel> channels_of(Aov, Statistic = Statistic::mean, Share = Share::all);

AovSet aovs_of(const std::vector<Channel>&);

}  // namespace tessera
