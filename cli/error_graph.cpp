// SPDX-License-Identifier: Apache-2.0
#include "cli/error_graph.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>

namespace tessera {
namespace {

constexpr int kLeastColumns = 8, kLeastRows = 2;
constexpr int kDotsAcross = 2, kDotsDown = 4;  // of a Braille character

// UTF-8 of U+2800 and those behind it: a bit a dot.
std::string braille(std::uint8_t dots) {
  return {'\xe2', static_cast<char>(0xa0 + (dots >> 6)), static_cast<char>(0x80 + (dots & 0x3f))};
}

class Canvas {
 public:
  Canvas(int columns, int rows)
      : columns_(columns), rows_(rows), dots_(static_cast<std::size_t>(columns) * rows) {}
  void dot(int x, int y) {  // from the upper left
    constexpr std::array<std::array<std::uint8_t, 4>, 2> kBits{
        {{0x01, 0x02, 0x04, 0x40}, {0x08, 0x10, 0x20, 0x80}}};
    dots_[static_cast<std::size_t>(y / kDotsDown) * columns_ + x / kDotsAcross] |=
        kBits.at(static_cast<std::size_t>(x % kDotsAcross)).at(static_cast<std::size_t>(y % kDotsDown));
  }
  // Dashes where nothing else is, in the row `dashes`.
  std::vector<std::string> lines(int dashes) const {
    std::vector<std::string> lines(static_cast<std::size_t>(rows_));
    for (int y = 0; y < rows_; ++y)
      for (int x = 0; x < columns_; ++x) {
        const std::uint8_t dots = dots_[static_cast<std::size_t>(y) * columns_ + x];
        lines[static_cast<std::size_t>(y)] += dots != 0 ? braille(dots) : y == dashes ? "╌" : " ";
      }
    return lines;
  }

 private:
  int columns_, rows_;
  std::vector<std::uint8_t> dots_;
};

// Decades to rows of dots.
struct Scale {
  double low = 0, high = 0;
  int dots = 0;
  int row(double log) const {
    return static_cast<int>(std::lround((high - log) / (high - low) * (dots - 1)));
  }
};

Scale scale_of(const std::vector<double>& logs, std::optional<double> target, int dots) {
  auto [low, high] = std::ranges::minmax(logs);
  if (target) {
    low = std::min(low, *target);
    high = std::max(high, *target);
  }
  const double room = std::max(0.05, 0.02 * (high - low));
  return {low - room, high + room, dots};
}

}  // namespace

std::vector<std::string> error_graph(const std::vector<float>& errors, std::optional<double> target,
                                     int columns, int rows) {
  std::vector<double> logs;
  for (const float e : errors)
    if (std::isfinite(e) && e > 0) logs.push_back(std::log10(e));
  if (logs.empty() || columns < kLeastColumns || rows < kLeastRows) return {};
  if (target) target = *target > 0 ? std::optional(std::log10(*target)) : std::nullopt;
  const Scale scale = scale_of(logs, target, kDotsDown * rows);
  Canvas canvas(columns, rows);
  const int last = kDotsAcross * columns - 1;
  for (int x = 0, before = -1; x <= last; ++x) {
    const double look = static_cast<double>(x) / last * static_cast<double>(logs.size() - 1);
    const auto i = std::min(static_cast<std::size_t>(look), logs.size() - 1),
               next = std::min(i + 1, logs.size() - 1);
    const int y = scale.row(std::lerp(logs[i], logs[next], look - static_cast<double>(i)));
    if (before < 0) before = y;
    for (int between = std::min(before, y); between <= std::max(before, y); ++between) canvas.dot(x, between);
    before = y;
  }
  return canvas.lines(target ? scale.row(*target) / kDotsDown : -1);
}

}  // namespace tessera
