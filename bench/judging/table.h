// SPDX-License-Identifier: Apache-2.0
// Tables in Markdown.
#pragma once

#include <fmt/format.h>

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace tessera::judging {

// `value(row, column)` for each of both, an optional text: empty where there is none. A row without any is
// left out.
template <typename Column, typename Value>
std::string table(std::string_view corner, const std::vector<std::string>& rows,
                  const std::vector<Column>& columns, const Value& value) {
  std::string text = fmt::format("| {} |", corner);
  for (const Column& c : columns) text += fmt::format(" {} |", c);
  text += "\n|---|";
  for (std::size_t i = 0; i < columns.size(); ++i) text += "---|";
  text += "\n";
  for (const std::string& row : rows) {
    std::string line = fmt::format("| `{}` |", row);
    bool any = false;
    for (const Column& c : columns) {
      const std::optional<std::string> cell = value(row, c);
      any |= cell.has_value();
      line += fmt::format(" {} |", cell.value_or(""));
    }
    if (any) text += line + "\n";
  }
  return text + "\n";
}

}  // namespace tessera::judging
