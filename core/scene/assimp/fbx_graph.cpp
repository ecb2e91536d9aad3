// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/fbx_graph.h"

#include <fmt/format.h>

#include <algorithm>

#include "core/error.h"

namespace tessera::assimp {
namespace {

constexpr int kMaxDepth = 64;

// Words, strings with their first quote, and the signs { } , : of a text FBX; comments go from ; to the end
// of a line.
class Tokens {
 public:
  explicit Tokens(std::string_view text) : left_(text) {}

  // Empty at the end.
  std::string_view next() {
    skip_blanks();
    if (left_.empty()) return {};
    std::size_t size = 1;
    if (left_[0] == '"')
      size = std::min(left_.find('"', 1), left_.size());
    else if (kSigns.find(left_[0]) == std::string_view::npos)
      size = std::min(left_.find_first_of(" \t\r\n\";{},:"), left_.size());
    const std::string_view token = left_.substr(0, size);
    left_.remove_prefix(std::min(size + (token[0] == '"' ? 1 : 0), left_.size()));
    return token;
  }

 private:
  static constexpr std::string_view kSigns = "{},:";

  void skip_blanks() {
    while (!left_.empty()) {
      if (left_[0] == ';')
        left_.remove_prefix(std::min(left_.find('\n'), left_.size()));
      else if (left_[0] == ' ' || left_[0] == '\t' || left_[0] == '\r' || left_[0] == '\n' ||
               left_[0] == '\0')
        left_.remove_prefix(1);
      else
        return;
    }
  }

  std::string_view left_;
};

// One spelling of a number.
std::string id_of(std::string_view token) {
  token.remove_prefix(std::min(token.find_first_not_of('0'), token.size()));
  return std::string(token);
}

}  // namespace

// Objects in the order of their distance from what is above them (Kahn 1962): those in a circle never come
// up.
void FbxGraph::check(std::uint64_t depth, const std::string& file) const {
  std::map<std::string, std::size_t> below;  // connections from below that are still to come
  std::map<std::string, std::uint64_t> height;
  for (const auto& [child, parents] : parents_) {
    below.try_emplace(child);
    for (const std::string& parent : parents) ++below[parent];
  }
  std::vector<std::string> ready;
  for (const auto& [object, count] : below)
    if (count == 0) ready.push_back(object);
  std::size_t done = 0;
  for (; !ready.empty(); ++done) {
    const std::string object = std::move(ready.back());
    ready.pop_back();
    const auto parents = parents_.find(object);
    if (parents == parents_.end()) continue;
    for (const std::string& parent : parents->second) {
      height[parent] = std::max(height[parent], height[object] + 1);
      if (height[parent] > depth)
        throw InputError(file, fmt::format("an object is below more than {} others", depth));
      if (--below[parent] == 0) ready.push_back(parent);
    }
  }
  if (done != below.size())
    throw InputError(file, "an object is below itself", "connections without a circle");
}

void read_text_connections(FbxGraph& graph, std::string_view text, const std::string& file) {
  Tokens tokens(text);
  int depth = 0;
  std::string_view word;  // the token before
  for (std::string_view token = tokens.next(); !token.empty(); token = tokens.next()) {
    if (token == "}") --depth;
    if (token == "{" && ++depth > kMaxDepth)
      throw InputError(file, fmt::format("braces are nested deeper than {}", kMaxDepth));
    if (token == ":" && word == "Layer") {
      token = tokens.next();
      if (token == "{" || token == "}") throw InputError(file, "a Layer has no number", "text FBX");
    } else if (token == ":" && word == "C") {
      const std::string_view kind = tokens.next();
      tokens.next();
      const std::string child = id_of(tokens.next());
      tokens.next();
      const std::string parent = id_of(tokens.next());
      if (kind == "\"OO") graph.connect(child, parent);
    }
    word = token;
  }
}

}  // namespace tessera::assimp
