// SPDX-License-Identifier: Apache-2.0
#include "core/scene/ply_header.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <charconv>
#include <sstream>

#include "core/error.h"

namespace tessera::ply {
namespace {

constexpr std::size_t kMaxHeader = 1'000'000, kMaxProperties = 1000;

struct TypeName {
  std::string_view name;
  Type type;
};
constexpr std::array<TypeName, 16> kTypes{{{"char", Type::int8},
                                           {"int8", Type::int8},
                                           {"uchar", Type::uint8},
                                           {"uint8", Type::uint8},
                                           {"short", Type::int16},
                                           {"int16", Type::int16},
                                           {"ushort", Type::uint16},
                                           {"uint16", Type::uint16},
                                           {"int", Type::int32},
                                           {"int32", Type::int32},
                                           {"uint", Type::uint32},
                                           {"uint32", Type::uint32},
                                           {"float", Type::float32},
                                           {"float32", Type::float32},
                                           {"double", Type::float64},
                                           {"float64", Type::float64}}};

class HeaderReader {
 public:
  HeaderReader(std::string_view bytes, const std::string& file) : bytes_(bytes), file_(file) {}

  Header read() {
    if (!bytes_.starts_with("ply")) refuse("does not begin with 'ply'");
    const std::size_t end = bytes_.substr(0, kMaxHeader).find("end_header");
    const std::size_t line_end = end == std::string_view::npos ? end : bytes_.find('\n', end);
    if (line_end == std::string_view::npos) refuse("the header has no end");
    header_.size = line_end + 1;
    std::istringstream lines{std::string(bytes_.substr(0, end))};
    bool has_format = false;
    for (std::string line; std::getline(lines, line);) {
      std::istringstream words(line);
      std::string word;
      words >> word;
      if (word == "format") read_format(words), has_format = true;
      if (word == "element") read_element(words);
      if (word == "property") read_property(words);
      if (word == "comment" && words >> word && word == "TextureFile")
        std::getline(words >> std::ws, header_.picture);
    }
    while (!header_.picture.empty() && header_.picture.back() == '\r') header_.picture.pop_back();
    if (!has_format) refuse("the header names no format");
    return std::move(header_);
  }

 private:
  [[noreturn]] void refuse(const std::string& what) const { throw InputError(file_, what, kAccepted); }

  void read_format(std::istringstream& words) {
    std::string name;
    words >> name;
    if (name == "ascii")
      header_.format = Format::text;
    else if (name == "binary_little_endian")
      header_.format = Format::little;
    else if (name == "binary_big_endian")
      header_.format = Format::big;
    else
      refuse(fmt::format("has the unknown format '{}'", name.substr(0, 40)));
  }

  // Each item of an element takes a byte or more.
  void read_element(std::istringstream& words) {
    Element element;
    std::string count;
    words >> element.name >> count;
    const auto [end, error] = std::from_chars(count.data(), count.data() + count.size(), element.count);
    if (error != std::errc() || end != count.data() + count.size())
      refuse(
          fmt::format("the header promises '{}' of '{}'", count.substr(0, 40), element.name.substr(0, 40)));
    if (element.count > bytes_.size() - header_.size)
      refuse(fmt::format("the header promises {} of '{}' in {} bytes", element.count,
                         element.name.substr(0, 40), bytes_.size() - header_.size));
    header_.elements.push_back(std::move(element));
  }

  void read_property(std::istringstream& words) {
    if (header_.elements.empty()) refuse("a property belongs to no element");
    Property property;
    std::string type;
    words >> type;
    if (type == "list") {
      words >> type;
      property.count = type_of(type);
      words >> type;
    }
    property.type = type_of(type);
    words >> property.name;
    std::vector<Property>& all = header_.elements.back().properties;
    if (all.size() == kMaxProperties)
      refuse(fmt::format("an element has more than {} properties", kMaxProperties));
    all.push_back(std::move(property));
  }

  Type type_of(const std::string& name) const {
    const auto it =
        std::find_if(kTypes.begin(), kTypes.end(), [&](const TypeName& t) { return t.name == name; });
    if (it == kTypes.end()) refuse(fmt::format("has the unknown type '{}'", name.substr(0, 40)));
    return it->type;
  }

  std::string_view bytes_;
  const std::string& file_;
  Header header_;
};

}  // namespace

Header read_header(std::string_view bytes, const std::string& file) {
  return HeaderReader(bytes, file).read();
}

}  // namespace tessera::ply
