// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/guard.h"

#include <fmt/format.h>

#include <cstring>

#include "core/error.h"
#include "core/scene/assimp/fbx_graph.h"

namespace tessera::assimp {
namespace {

constexpr int kMaxDepth = 64;
constexpr std::uint64_t kMaxInflation = 1100;  // deflate packs at most about 1032 bytes in one
constexpr std::string_view kBinary("Kaydara FBX Binary  \0", 21);
constexpr std::size_t kHeader = 27;

// The records of a binary FBX: end, property count and length (32 bits, 64 from version 7500 on), name; its
// properties; records in it until its end or an empty one.
class Records {
 public:
  Records(std::string_view bytes, const ImportLimits& limits, const std::string& file)
      : bytes_(bytes), limits_(limits), file_(file) {
    if (bytes.size() < kHeader) refuse("the file is cut short");
    wide_ = number(23, 4) >= 7500;
  }

  void check() {
    check_list(kHeader, bytes_.size(), 0);
    graph_.check(limits_.node_depth, file_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw InputError(file_, what, "binary FBX"); }

  std::uint64_t number(std::uint64_t at, std::size_t size) const {
    if (at > bytes_.size() || size > bytes_.size() - at) refuse(fmt::format("is cut short at byte {}", at));
    std::uint64_t value = 0;
    std::memcpy(&value, bytes_.data() + at, size);
    return value;
  }

  // Records from `at` on; ends at an empty one.
  void check_list(std::uint64_t at, std::uint64_t end, int depth) {
    if (depth > kMaxDepth) refuse(fmt::format("records are nested deeper than {}", kMaxDepth));
    const std::size_t word = wide_ ? 8 : 4;
    while (at < end) {
      const std::uint64_t next = number(at, word), properties = number(at + word, word),
                          length = number(at + 2 * word, word), name = number(at + 3 * word, 1);
      if (next == 0) return;
      const std::uint64_t first = at + 3 * word + 1 + name;
      if (next > end || first > next || length > next - first)
        refuse(fmt::format("the record at byte {} reaches out of what it lies in", at));
      check_properties(first, length, properties);
      check_meaning(bytes_.substr(first - name, name), bytes_.substr(first, length), properties);
      check_list(first + length, next, depth + 1);
      at = next;
    }
  }

  // Properties of a connection: "OO", then the ids of two objects.
  void check_meaning(std::string_view name, std::string_view properties, std::uint64_t count) {
    if (name == "Layer" && count == 0) refuse("a Layer has no number");
    constexpr std::string_view kKind("S\2\0\0\0OO", 7);
    if (name == "C" && properties.starts_with(kKind) && properties.size() == 25)
      graph_.connect(std::string(properties.substr(8, 8)), std::string(properties.substr(17, 8)));
  }

  void check_properties(std::uint64_t at, std::uint64_t length, std::uint64_t count) {
    const std::uint64_t end = at + length;
    for (std::uint64_t p = 0; p < count; ++p) {
      if (at >= end) refuse(fmt::format("a list of properties ends at byte {}", at));
      const char type = bytes_[at];
      at += 1 + size_of(type, at + 1);
      if (at > end) refuse(fmt::format("a property reaches beyond byte {}", end));
    }
  }

  std::uint64_t size_of(char type, std::uint64_t at) {
    switch (type) {
      case 'C':
      case 'B':
        return 1;
      case 'Y':
        return 2;
      case 'I':
      case 'F':
        return 4;
      case 'D':
      case 'L':
        return 8;
      case 'S':
      case 'R':
        return 4 + number(at, 4);
      case 'f':
      case 'i':
        return array_size(at, 4);
      case 'd':
      case 'l':
        return array_size(at, 8);
      case 'b':
      case 'c':
        return array_size(at, 1);
      default:
        refuse(fmt::format("the property before byte {} has an unknown type", at));
    }
  }

  std::uint64_t array_size(std::uint64_t at, std::uint64_t element) {
    const std::uint64_t bytes = number(at, 4) * element, encoding = number(at + 4, 4),
                        packed = number(at + 8, 4);
    if (encoding > 1 || (encoding == 0 && packed != bytes) || bytes > kMaxInflation * packed)
      refuse(fmt::format("the array at byte {} cannot have {} bytes", at, bytes));
    require_at_most(limits_.file_bytes, unpacked_ += bytes, "bytes in the arrays of this file", file_);
    return 12 + packed;
  }

  std::string_view bytes_;
  const ImportLimits& limits_;
  const std::string& file_;
  bool wide_ = false;
  std::uint64_t unpacked_ = 0;
  FbxGraph graph_;
};

}  // namespace

void check_obj(std::string_view bytes, const std::string& file) {
  if (bytes.find('\0') != std::string::npos) throw InputError(file, "this is no text", "Wavefront OBJ");
}

void check_fbx(std::string_view bytes, const ImportLimits& limits, const std::string& file) {
  if (bytes.starts_with(kBinary)) return Records(bytes, limits, file).check();
  FbxGraph graph;
  read_text_connections(graph, bytes, file);
  graph.check(limits.node_depth, file);
}

}  // namespace tessera::assimp
