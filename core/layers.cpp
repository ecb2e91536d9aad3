// SPDX-License-Identifier: Apache-2.0
#include "core/layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <set>

namespace tessera {
namespace {

constexpr std::string_view kStatistics[] = {"", "_variance", "_third", ""};
constexpr std::string_view kShares[] = {"", "_even", "_odd"};

std::string file_layer(const Channel& c) {
  const std::string_view statistic = kStatistics[static_cast<int>(c.statistic)];
  std::string base(info(c.aov).name);
  if (c.statistic == Statistic::samples) {
    base = "samples";
  } else if (c.aov == Aov::color) {  // its bare name is the delivered image's
    base = c.statistic == Statistic::mean ? "noisy" : statistic.substr(1);
  } else {
    if (c.aov == Aov::depth && c.statistic != Statistic::mean) base = "depth";
    base += statistic;
  }
  return base + std::string(kShares[static_cast<int>(c.share)]);
}

std::string file_letter(const Channel& c) {
  return c.statistic == Statistic::samples ? "Y" : channel_name(c.aov, c.index);
}

std::string joined(std::string_view layer, std::string_view letter) {
  return layer.empty() ? std::string(letter) : fmt::format("{}.{}", layer, letter);
}

struct OtherLayer {
  std::string_view name;
  std::string_view letters = {};  // of its channels, where they are other ones than those of `info`
  std::array<float, 2> scale = {1, 1};
};

// Cycles' vectors are X, Y = before - now and Z, W = now - after, in pixels, y upwards.
constexpr std::array<float, 2> kCyclesVector{-1, 1};

// What others call the mean of all samples, the noisy one of two pictures first.
std::vector<OtherLayer> other_layers(const Channel& c) {
  if (c.statistic != Statistic::mean || c.share != Share::all) return {};
  switch (c.aov) {
    case Aov::color:
      return {{"Noisy Image"}, {""}, {"Combined"}};
    case Aov::albedo:
      return {{"Denoising Albedo"}, {"Albedo"}};
    case Aov::normal:
      return {{"Denoising Normal"}, {"Ns"}, {"Normal"}, {"normal"}};
    case Aov::position:
      return {{"Position"}};
    case Aov::depth:
      return {{"Depth"}, {"depth"}, {"Denoising Depth"}};
    case Aov::motion:
      return {{"Vector", "XY", kCyclesVector}, {"Vector", "RG", kCyclesVector}};
    case Aov::next_motion:
      return {{"Vector", "ZW", kCyclesVector}, {"Vector", "BA", kCyclesVector}};
    case Aov::object_id:
      return {{"IndexOB"}, {"Object Index"}};
    case Aov::material_id:
      return {{"IndexMA"}, {"Material Index"}};
    default:
      return {};
  }
}

constexpr std::array<std::string_view, 5> kMotionOfUnknownUnit{"motionvector", "motion_vector",
                                                               "MotionVectors", "VRayVelocity", "velocity"};

// Vectors are X, Y, Z or R, G, B; a single number goes by several letters.
std::vector<std::string> letters_of(const Channel& c) {
  const auto index = static_cast<std::size_t>(c.index);
  const std::string own = file_letter(c);
  std::vector<std::string> letters{own};
  if (info(c.aov).letters == "XYZ") letters.emplace_back(1, "RGB"[index]);
  if (info(c.aov).letters.size() == 1)
    for (const char* l : {"V", "Z", "Y", "R", "X"})
      if (l != own) letters.emplace_back(l);
  return letters;
}

// In a layer. Without its name only its own letters are: a picture's R is no depth.
std::vector<std::string> letters_in(const OtherLayer& layer, const Channel& c) {
  if (!layer.letters.empty()) return {std::string(1, layer.letters[static_cast<std::size_t>(c.index)])};
  return layer.name.empty() ? std::vector{file_letter(c)} : letters_of(c);
}

// Of the name, or of any that ends in it after a view layer's.
std::optional<int> named_plane(const ExrImage& file, std::string_view layer, std::string_view letter) {
  const std::string name = joined(layer, letter);
  if (const int plane = file.plane(name); plane >= 0) return plane;
  if (layer.empty()) return std::nullopt;  // ViewLayer.R would be any layer's R
  const std::string behind = "." + name;
  const auto at =
      std::ranges::find_if(file.channels, [&](const ExrChannel& e) { return e.name.ends_with(behind); });
  if (at == file.channels.end()) return std::nullopt;
  return static_cast<int>(at - file.channels.begin());
}

}  // namespace

std::string file_channel(const Channel& c) { return joined(file_layer(c), file_letter(c)); }

std::optional<FilePlane> find_plane(const ExrImage& file, const Channel& c) {
  if (const int own = file.plane(file_channel(c)); own >= 0) return FilePlane{own};
  std::vector<OtherLayer> layers = other_layers(c);
  const std::string ours = file_layer(c);
  layers.insert(layers.begin(), {.name = ours});
  for (const OtherLayer& layer : layers)
    for (const std::string& letter : letters_in(layer, c))
      if (const auto plane = named_plane(file, layer.name, letter))
        return FilePlane{*plane, c.index < 2 ? layer.scale[static_cast<std::size_t>(c.index)] : 1};
  return std::nullopt;
}

std::optional<FilePlane> find_plane_alone(const ExrImage& file, const Channel& c) {
  if (const auto named = find_plane(file, c)) return named;
  for (const std::string& letter : letters_of(c))
    if (const auto plane = named_plane(file, "", letter)) return FilePlane{*plane};
  if (const auto plane = named_plane(file, "", std::string(1, "RGB"[std::min(c.index, 2)]));
      plane && c.index < 3)
    return FilePlane{*plane};
  const bool single = c.statistic == Statistic::samples || info(c.aov).channels == 1;
  return single && file.pixels.planes() == 1 ? std::optional(FilePlane{0}) : std::nullopt;
}

std::optional<FilePlane> find_variance_of_samples(const ExrImage& file, const Channel& c) {
  if (c.aov != Aov::color || c.statistic != Statistic::variance_of_mean || c.share != Share::all)
    return std::nullopt;
  const auto plane = named_plane(file, "Variance", file_letter(c));
  return plane ? std::optional(FilePlane{*plane}) : std::nullopt;
}

std::optional<FilePlane> find_motion_of_unknown_unit(const ExrImage& file, const Channel& c) {
  if (c.aov != Aov::motion) return std::nullopt;
  for (const std::string_view layer : kMotionOfUnknownUnit)
    for (const std::string_view letters : {"XY", "RG"})
      if (const auto plane = named_plane(file, layer, letters.substr(static_cast<std::size_t>(c.index), 1)))
        return FilePlane{*plane};
  return std::nullopt;
}

std::string layer_of(const Channel& c) {
  const std::string whole = file_channel(c);
  return whole.substr(0, whole.rfind('.'));
}

std::vector<std::string> layer_names() {
  std::set<std::string> names{layer_of(kSampleCount)};
  for (int a = 0; a < kAovs; ++a) {
    if (!is_aov(a) || info(static_cast<Aov>(a)).channels == 0) continue;
    for (const Statistic s : {Statistic::mean, Statistic::variance_of_mean, Statistic::third_moment})
      for (const Share share : {Share::all, Share::a, Share::b})
        names.insert(layer_of({static_cast<Aov>(a), 0, s, share}));
  }
  return {names.begin(), names.end()};
}

std::string accepted_layers(const Channel& c) {
  const std::string_view letters = c.statistic == Statistic::samples ? "Y" : info(c.aov).letters;
  const auto whole = [&](std::string_view layer, std::string_view own_letters) {
    const std::string_view all = own_letters.empty() ? letters : own_letters;
    if (all.empty()) return std::string(layer);
    return layer.empty() ? fmt::format("{}", fmt::join(all, ", ")) : fmt::format("{}.{}", layer, all);
  };
  std::vector<std::string> others;
  for (const OtherLayer& layer : other_layers(c)) others.push_back(whole(layer.name, layer.letters));
  return whole(file_layer(c), "") + (others.empty() ? "" : fmt::format(" (or {})", fmt::join(others, "; ")));
}

}  // namespace tessera
