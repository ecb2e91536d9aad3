// SPDX-License-Identifier: Apache-2.0
// Text for terminals: widths, colours, and strangers' words without control characters.
#pragma once

#include <string>
#include <string_view>

namespace tessera {

// Columns that UTF-8 text takes, without its colours; each character takes one.
int shown_width(std::string_view text);
// The first `columns` of it; colours are switched off behind them.
std::string cut(std::string_view text, int columns);
// With '?' for what a terminal would obey.
std::string plain(std::string_view text);

// SGR parameters, e.g. "31"; the text as it is without colours, or without parameters.
std::string coloured(std::string_view text, std::string_view parameters, bool colours);

// Of how many eighths of a character are full: U+2588 and the like.
std::string progress_bar(double fraction, int columns);

}  // namespace tessera
