// SPDX-License-Identifier: Apache-2.0
// The cells of a frame as coloured blocks of a terminal.
#pragma once

#include <string>
#include <vector>

#include "core/acceptance.h"

namespace tessera {

// Lines of at most `columns` characters, at most `rows` of them; `wide`: cells in a row. A character with
// colours is two blocks one above the other, without one. A block is one cell, or as many as must share it
// for all to be shown: then it is open if one of them is, else exhausted if one is. No cells, no lines.
std::vector<std::string> cell_map(const std::vector<CellStatus>& cells, int wide, int columns, int rows,
                                  bool colours);

}  // namespace tessera
