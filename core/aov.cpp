// SPDX-License-Identifier: Apache-2.0
#include "core/aov.h"

#include <array>
#include <cassert>

namespace tessera {
namespace {

constexpr std::array<AovInfo, kAovs> kInfo{{
    {Aov::color, "", "RGB", true},
    {Aov::direct, "direct", "RGB", true},
    {Aov::indirect, "indirect", "RGB", true},
    {Aov::emission, "emission", "RGB", false},
    {Aov::albedo, "albedo", "RGB", false},
    {Aov::normal, "N", "XYZ", false},
    {Aov::position, "P", "XYZ", false},
    {Aov::depth, "", "Z", false},
}};

}  // namespace

const AovInfo& info(Aov a) { return kInfo[static_cast<std::size_t>(a)]; }

FilmLayout::FilmLayout(AovSet aovs) : aovs_(aovs), planes_(4) {
  for (const AovInfo& i : kInfo) {
    if (!aovs.has(i.aov)) continue;
    first_[static_cast<int>(i.aov)] = planes_;
    planes_ += 2 * static_cast<int>(i.channels.size()) * (i.squares ? 2 : 1);
  }
}

int FilmLayout::square(Aov a, int channel, Half h) const {
  const AovInfo& i = info(a);
  assert(aovs_.has(a) && i.squares);
  return first_[static_cast<int>(a)] + 2 * (static_cast<int>(i.channels.size()) + channel) +
         static_cast<int>(h);
}

std::vector<Channel> channels_of(Aov a, Statistic statistic) {
  std::vector<Channel> channels;
  for (int c = 0; c < static_cast<int>(info(a).channels.size()); ++c) channels.push_back({a, c, statistic});
  return channels;
}

AovSet aovs_of(const std::vector<Channel>& channels) {
  AovSet set;
  for (const Channel& c : channels) set = set | AovSet{c.aov};
  return set;
}

}  // namespace tessera
