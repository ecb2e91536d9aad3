// SPDX-License-Identifier: Apache-2.0
#include "core/aov.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>

namespace tessera {
namespace {

using enum Reduction;

constexpr std::array<std::string_view, 8> kGroupNames{"group0", "group1", "group2", "group3",
                                                      "group4", "group5", "group6", "group7"};

constexpr std::array<AovInfo, kAovs> table() {
  std::array<AovInfo, kAovs> t{{
      {Aov::color, "", "RGB", 3, 2, mean},
      {Aov::direct, "direct", "RGB", 3, 2, mean},
      {Aov::indirect, "indirect", "RGB", 3, 2, mean},
      {Aov::emission, "emission", "RGB", 3, 1, mean},
      {Aov::albedo, "albedo", "RGB", 3, 1, mean},
      {Aov::normal, "N", "XYZ", 3, 1, mean},
      {Aov::position, "P", "XYZ", 3, 1, mean},
      {Aov::depth, "", "Z", 1, 1, mean},
      {Aov::texture2, "texture2", "RGB", 3, 2, mean},
      {Aov::bounce, "bounce", "XYZ", 3, 2, mean},
      {Aov::shading, "shading", "Y", 1, 2, mean},
      {Aov::histogram, "histogram", "", 3 * kHistogramBins, 1, mean},
      {Aov::box_cox, "boxcox", "RGB", 3, 3, mean},
      {Aov::guide_squares, "guide_variance", "", 0, 1, mean},
      {Aov::motion, "motion", "XY", 2, 1, point},
      {Aov::previous_depth, "previous", "Z", 1, 1, point},
      {Aov::geometric_normal, "Ng", "XYZ", 3, 1, point},
      {Aov::object_id, "object_id", "Y", 1, 1, point},
      {Aov::material_id, "material_id", "Y", 1, 1, point},
      {Aov::depth_gradient, "depth_gradient", "XY", 2, 1, point},
      {Aov::object_matte, "CryptoObject", "", 2 * kMatteRanks, 1, ranks},
      {Aov::material_matte, "CryptoMaterial", "", 2 * kMatteRanks, 1, ranks},
      {Aov::sample_vectors, "samples_rpf", "", SampleVector::size * 4, 1, per_sample},
  }};
  for (int g = 0; g < 8; ++g)
    t[static_cast<std::size_t>(light_group_aov(g))] = {
        light_group_aov(g), kGroupNames[static_cast<std::size_t>(g)], "RGB", 3, 1, mean};
  t[static_cast<std::size_t>(Aov::next_motion)] = {Aov::next_motion, "next_motion", "XY", 2, 1, point};
  t[static_cast<std::size_t>(Aov::next_depth)] = {Aov::next_depth, "next", "Z", 1, 1, point};
  return t;
}
constexpr std::array<AovInfo, kAovs> kInfo = table();

bool has_guide_squares(Aov a) {
  return a == Aov::albedo || a == Aov::normal || a == Aov::position || a == Aov::depth;
}

}  // namespace

const AovInfo& info(Aov a) { return kInfo[static_cast<std::size_t>(a)]; }

std::string channel_name(Aov a, int channel) {
  const AovInfo& i = info(a);
  if (!i.letters.empty()) return std::string(1, i.letters[static_cast<std::size_t>(channel)]);
  if (a == Aov::histogram)
    return fmt::format("{}{:02}", "RGB"[channel / kHistogramBins], channel % kHistogramBins);
  return fmt::format("{:03}", channel);
}

// Edges at 7.5 (b / 20)^2.2.
int histogram_bin(float value) {
  if (!(value > 0)) return 0;
  const float share = std::pow(std::min(value, 7.5f) / 7.5f, 1 / 2.2f);
  return std::min(static_cast<int>(share * kHistogramBins), kHistogramBins - 1);
}

FilmLayout::FilmLayout(AovSet aovs) : aovs_(aovs), planes_(4) {
  for (const AovInfo& i : kInfo) {
    if (!aovs.has(i.aov) || i.channels == 0) continue;
    first_[static_cast<int>(i.aov)] = planes_;
    if (i.reduction == ranks) rank_lists_.insert(rank_lists_.end(), {planes_, planes_ + 1});
    planes_ += 2 * i.channels * moments(i.aov);
  }
}

int FilmLayout::moments(Aov a) const {
  return aovs_.has(Aov::guide_squares) && has_guide_squares(a) ? 2 : info(a).moments;
}

int FilmLayout::sum(Aov a, int channel, Half h, int power) const {
  assert(aovs_.has(a) && channel < info(a).channels && power >= 1 && power <= moments(a));
  return first_[static_cast<int>(a)] + 2 * ((power - 1) * info(a).channels + channel) + static_cast<int>(h);
}

std::vector<int> FilmLayout::planes_of(const FilmLayout& part) const {
  std::vector<int> planes{0, 1, 2, 3};
  for (const AovInfo& i : kInfo) {
    if (!part.aovs_.has(i.aov)) continue;
    for (int power = 1; power <= part.moments(i.aov); ++power)
      for (int c = 0; c < i.channels; ++c)
        for (const Half h : {Half::a, Half::b}) planes.push_back(sum(i.aov, c, h, power));
  }
  return planes;
}

std::vector<Channel> channels_of(Aov a, Statistic statistic, Share share) {
  std::vector<Channel> channels;
  for (int c = 0; c < info(a).channels; ++c) channels.push_back({a, c, statistic, share});
  return channels;
}

AovSet aovs_of(const std::vector<Channel>& channels) {
  AovSet set;
  for (const Channel& c : channels) {
    set = set | AovSet{c.aov};
    if (c.statistic == Statistic::variance_of_mean && info(c.aov).moments < 2)
      set = set | AovSet{Aov::guide_squares};
  }
  return set;
}

}  // namespace tessera
