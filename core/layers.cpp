// SPDX-License-Identifier: Apache-2.0
#include "core/layers.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

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

// What others call the mean of all samples, the noisy one of two pictures first.
std::vector<std::string_view> other_layers(const Channel& c) {
  if (c.statistic != Statistic::mean || c.share != Share::all) return {};
  switch (c.aov) {
    case Aov::color:
      return {"Noisy Image", "", "Combined"};
    case Aov::albedo:
      return {"Denoising Albedo", "Albedo"};
    case Aov::normal:
      return {"Denoising Normal", "Ns", "Normal", "normal"};
    case Aov::position:
      return {"Position"};
    case Aov::depth:
      return {"Depth", "depth", "Denoising Depth"};
    case Aov::motion:
      return {"Vector"};
    default:
      return {};
  }
}

// Vectors are X, Y, Z or R, G, B; a single number goes by several letters.
std::vector<std::string> other_letters(const Channel& c) {
  const std::string own = file_letter(c);
  std::vector<std::string> letters{own};
  const auto index = static_cast<std::size_t>(c.index);
  if (info(c.aov).letters == "XYZ") letters.emplace_back(1, "RGB"[index]);
  if (info(c.aov).letters.size() == 1)
    for (const char* l : {"V", "Z", "Y", "R"})
      if (l != own) letters.emplace_back(l);
  return letters;
}

}  // namespace

std::string file_channel(const Channel& c) { return joined(file_layer(c), file_letter(c)); }

int plane_of(const ExrImage& file, const Channel& c) {
  if (const int own = file.plane(file_channel(c)); own >= 0) return own;
  std::vector<std::string_view> layers = other_layers(c);
  const std::string ours = file_layer(c);
  layers.insert(layers.begin(), ours);
  for (const std::string_view layer : layers)
    for (const std::string& letter : other_letters(c)) {
      const std::string name = joined(layer, letter);
      if (const int plane = file.plane(name); plane >= 0) return plane;
      if (layer.empty()) continue;  // ViewLayer.R would be any layer's R
      const std::string behind = "." + name;
      const auto at =
          std::ranges::find_if(file.channels, [&](const ExrChannel& e) { return e.name.ends_with(behind); });
      if (at != file.channels.end()) return static_cast<int>(at - file.channels.begin());
    }
  return -1;
}

std::string accepted_layers(const Channel& c) {
  const std::string_view letters = c.statistic == Statistic::samples ? "Y" : info(c.aov).letters;
  const auto whole = [&](std::string_view layer) {
    return layer.empty() ? fmt::format("{}", fmt::join(letters, ", ")) : fmt::format("{}.{}", layer, letters);
  };
  std::vector<std::string> others;
  for (const std::string_view layer : other_layers(c)) others.push_back(whole(layer));
  return whole(file_layer(c)) + (others.empty() ? "" : fmt::format(" (or {})", fmt::join(others, "; ")));
}

}  // namespace tessera
