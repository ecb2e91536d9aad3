// SPDX-License-Identifier: Apache-2.0
// The lines of key files and allow-lists: words between white space. A line that begins with '#' says
// nothing, nor does what follows a '#' that stands alone (a key may hold the character).
#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

struct KeyLine {
  int number = 1;                  // of the line, from 1
  std::vector<std::string> words;  // at least one
};

// Empty lines are left out. `where` names the text in errors. Throws InputError for control characters.
std::vector<KeyLine> key_lines(std::string_view text, std::string_view where);

// The whole file, at most 16 MiB. Throws InputError. If `secret`, files that anybody but their owner may read
// are refused.
std::string read_key_text(const std::filesystem::path&, bool secret);

}  // namespace tessera
