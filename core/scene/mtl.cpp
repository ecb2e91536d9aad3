// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mtl.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <sstream>

namespace tessera {
namespace {

// Statements that carry numbers, and how many.
struct Numbers {
  std::string_view name;
  int count;
};
constexpr std::array<Numbers, 12> kNumbers{{{"Ka", 3},
                                            {"Kd", 3},
                                            {"Ks", 3},
                                            {"Ke", 3},
                                            {"Tf", 3},
                                            {"d", 1},
                                            {"Tr", 1},
                                            {"Ns", 1},
                                            {"Ni", 1},
                                            {"Pr", 1},
                                            {"Pm", 1},
                                            {"illum", 1}}};
constexpr std::array<std::string_view, 3> kMaps{"map_Kd", "map_Ke", "map_d"};

// `statement` in canonical form; empty if it is none we know, or not whole.
std::string canonical(const std::string& statement) {
  std::istringstream words(statement);
  std::string name, word, rest;
  words >> name;
  const auto numbers =
      std::find_if(kNumbers.begin(), kNumbers.end(), [&](const Numbers& n) { return n.name == name; });
  if (numbers != kNumbers.end()) {
    for (int i = 0; i < numbers->count; ++i) {
      double value = 0;
      if (!(words >> value) || !std::isfinite(value) || std::abs(value) > 1e12) return {};
      rest += fmt::format(" {:.9g}", value);
    }
    return name + rest;
  }
  if (name != "newmtl" && std::find(kMaps.begin(), kMaps.end(), name) == kMaps.end()) return {};
  std::getline(words >> std::ws, rest);
  while (!rest.empty() && std::isspace(static_cast<unsigned char>(rest.back()))) rest.pop_back();
  const bool options = name != "newmtl" && rest.starts_with("-");
  return rest.empty() || options || rest.size() > 1000 ? std::string() : name + " " + rest;
}

}  // namespace

CheckedMtl checked_mtl(std::string_view text) {
  CheckedMtl checked;
  std::istringstream lines{std::string(text)};
  std::string material;
  bool in_material = false;
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    ++number;
    std::erase(line, '\0');
    const std::size_t first = line.find_first_not_of(" \t\r");
    if (first == std::string::npos || line[first] == '#') continue;
    const std::string statement = canonical(line);
    if (statement.starts_with("newmtl ")) in_material = true, material = statement.substr(7);
    if (in_material && (statement.starts_with("Pr ") || statement.starts_with("Pm ")))
      checked.physical.insert(material);
    if (statement.empty() || !in_material)
      checked.warnings.push_back(fmt::format("{}: '{}' is left out", number, line.substr(first, 40)));
    else
      checked.text += statement + "\n";
  }
  return checked;
}

}  // namespace tessera
