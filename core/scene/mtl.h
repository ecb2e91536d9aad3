// SPDX-License-Identifier: Apache-2.0
// A material file of a Wavefront OBJ, made safe: assimp trusts statements to be whole and in order.
#pragma once

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace tessera {

struct CheckedMtl {
  std::string text;                   // only statements we know, whole, each after a newmtl
  std::set<std::string> physical;     // materials with Pr or Pm
  std::vector<std::string> warnings;  // "line: what is left out"
};
CheckedMtl checked_mtl(std::string_view text);

}  // namespace tessera
