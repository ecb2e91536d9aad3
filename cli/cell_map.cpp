// SPDX-License-Identifier: Apache-2.0
#include "cli/cell_map.h"

#include <fmt/format.h>

#include <algorithm>

namespace tessera {
namespace {

struct Grid {
  std::vector<CellStatus> blocks;
  int wide = 0, high = 0;
};

int divided(int a, int b) { return (a + b - 1) / b; }

// The state that most calls for attention.
CellStatus worse(CellStatus a, CellStatus b) {
  const auto rank = [](CellStatus s) {
    return s == CellStatus::open ? 2 : s == CellStatus::exhausted ? 1 : 0;
  };
  return rank(a) >= rank(b) ? a : b;
}

Grid shrunk(const std::vector<CellStatus>& cells, int wide, int share) {
  const int high = divided(static_cast<int>(cells.size()), wide);
  Grid grid{{}, divided(wide, share), divided(high, share)};
  grid.blocks.assign(static_cast<std::size_t>(grid.wide) * grid.high, CellStatus::accepted);
  for (int i = 0; i < static_cast<int>(cells.size()); ++i) {
    CellStatus& block =
        grid.blocks[static_cast<std::size_t>(i / wide / share) * grid.wide + i % wide / share];
    block = worse(block, cells[static_cast<std::size_t>(i)]);
  }
  return grid;
}

int colour_of(CellStatus s) { return s == CellStatus::open ? 3 : s == CellStatus::accepted ? 2 : 1; }

const char* letter_of(CellStatus s) {
  return s == CellStatus::open ? "·" : s == CellStatus::accepted ? "█" : "x";
}

std::string two_rows(const Grid& grid, int y) {
  std::string line;
  for (int x = 0; x < grid.wide; ++x) {
    const int upper = colour_of(grid.blocks[static_cast<std::size_t>(y) * grid.wide + x]);
    line += y + 1 < grid.high
                ? fmt::format("\x1b[3{};4{}m▀", upper,
                              colour_of(grid.blocks[static_cast<std::size_t>(y + 1) * grid.wide + x]))
                : fmt::format("\x1b[0;3{}m▀", upper);
  }
  return line + "\x1b[0m";
}

}  // namespace

std::vector<std::string> cell_map(const std::vector<CellStatus>& cells, int wide, int columns, int rows,
                                  bool colours) {
  if (cells.empty() || wide < 1 || columns < 1 || rows < 1) return {};
  const int step = colours ? 2 : 1, high = divided(static_cast<int>(cells.size()), wide);
  const int share = std::max({1, divided(wide, columns), divided(high, step * rows)});
  const Grid grid = shrunk(cells, wide, share);
  std::vector<std::string> lines;
  for (int y = 0; y < grid.high; y += step) {
    if (colours) {
      lines.push_back(two_rows(grid, y));
      continue;
    }
    lines.emplace_back();
    for (int x = 0; x < grid.wide; ++x)
      lines.back() += letter_of(grid.blocks[static_cast<std::size_t>(y) * grid.wide + x]);
  }
  return lines;
}

}  // namespace tessera
