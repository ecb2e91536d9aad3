// SPDX-License-Identifier: Apache-2.0
// Errors at each look against the target, drawn with the dots of Braille characters.
#pragma once

#include <optional>
#include <string>
#include <vector>

namespace tessera {

// `rows` lines of exactly `columns` characters, logarithmic upwards, from the first look to the last, joined
// by straight lines; the target as a line of dashes. Values that are not above 0 and finite are left out; no
// lines if none is left, or there is no room for 8 columns and 2 rows.
std::vector<std::string> error_graph(const std::vector<float>& errors, std::optional<double> target,
                                     int columns, int rows);

}  // namespace tessera
