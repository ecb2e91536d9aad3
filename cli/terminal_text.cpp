// SPDX-License-Identifier: Apache-2.0
#include "cli/terminal_text.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace tessera {
namespace {

// Bytes of what begins at `at`: a colour (ESC [ ... m), or one character.
struct Item {
  std::size_t bytes = 1;
  bool colour = false;
};

Item item_at(std::string_view text, std::size_t at) {
  if (text[at] == '\x1b') {
    const std::size_t end = text.find('m', at);
    return {(end == text.npos ? text.size() : end + 1) - at, true};
  }
  std::size_t end = at + 1;
  while (end < text.size() && (static_cast<unsigned char>(text[end]) & 0xc0) == 0x80) ++end;
  return {end - at, false};
}

}  // namespace

int shown_width(std::string_view text) {
  int width = 0;
  for (std::size_t at = 0; at < text.size();) {
    const Item item = item_at(text, at);
    width += item.colour ? 0 : 1;
    at += item.bytes;
  }
  return width;
}

std::string cut(std::string_view text, int columns) {
  int width = 0;
  bool colour = false;
  for (std::size_t at = 0; at < text.size();) {
    const Item item = item_at(text, at);
    colour = colour || item.colour;
    if (!item.colour && ++width > columns) return std::string(text.substr(0, at)) + (colour ? "\x1b[0m" : "");
    at += item.bytes;
  }
  return std::string(text);
}

std::string plain(std::string_view text) {
  std::string out;
  for (std::size_t at = 0; at < text.size();) {
    const std::size_t bytes = text[at] == '\x1b' ? 1 : item_at(text, at).bytes;
    const auto first = static_cast<unsigned char>(text[at]);
    const bool c1 = first == 0xc2 && bytes > 1 && static_cast<unsigned char>(text[at + 1]) < 0xa0;
    const bool stray = first >= 0x80 && (first < 0xc2 || bytes < 2);
    if (first < 0x20 || first == 0x7f || c1 || stray)
      out += '?';
    else
      out += text.substr(at, bytes);
    at += bytes;
  }
  return out;
}

std::string coloured(std::string_view text, std::string_view parameters, bool colours) {
  if (!colours || parameters.empty()) return std::string(text);
  return fmt::format("\x1b[{}m{}\x1b[0m", parameters, text);
}

std::string progress_bar(double fraction, int columns) {
  constexpr std::array<std::string_view, 8> kParts{" ", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
  const int eighths =
      static_cast<int>(std::floor(std::clamp(fraction, 0.0, 1.0) * 8 * static_cast<double>(columns)));
  std::string bar;
  for (int i = 0; i < columns; ++i) {
    const int full = std::clamp(eighths - 8 * i, 0, 8);
    bar += full == 8 ? "█" : kParts.at(static_cast<std::size_t>(full));
  }
  return bar;
}

}  // namespace tessera
