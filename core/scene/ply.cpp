// SPDX-License-Identifier: Apache-2.0
#include "core/scene/ply.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>

#include "core/error.h"
#include "core/scene/import.h"
#include "core/scene/pictures.h"
#include "core/scene/ply_header.h"
#include "core/scene/roots.h"
#include "core/scene/srgb.h"

namespace tessera {
namespace {

using ply::Element;
using ply::Format;
using ply::Property;
using ply::Type;

// The numbers after the header, one after the other.
class Numbers {
 public:
  Numbers(std::string_view bytes, Format format, const std::string& file)
      : left_(bytes), format_(format), file_(file) {}

  double next(Type type) {
    if (format_ == Format::text) return next_word();
    switch (type) {
      case Type::int8:
        return next_bytes<std::int8_t>();
      case Type::uint8:
        return next_bytes<std::uint8_t>();
      case Type::int16:
        return next_bytes<std::int16_t>();
      case Type::uint16:
        return next_bytes<std::uint16_t>();
      case Type::int32:
        return next_bytes<std::int32_t>();
      case Type::uint32:
        return next_bytes<std::uint32_t>();
      case Type::float32:
        return next_bytes<float>();
      default:
        return next_bytes<double>();
    }
  }

  // How many numbers follow in a list.
  std::uint64_t length(const Property& list) {
    const double count = next(*list.count);
    if (!(count >= 0 && count <= static_cast<double>(left_.size())))
      throw InputError(file_, fmt::format("a list '{}' of {} numbers", list.name, count),
                       "no more than the file has bytes");
    return static_cast<std::uint64_t>(count);
  }

 private:
  [[noreturn]] void refuse_end() const { throw InputError(file_, "the file is cut short", ply::kAccepted); }

  template <class T>
  T next_bytes() {
    if (left_.size() < sizeof(T)) refuse_end();
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), left_.data(), sizeof(T));
    if (format_ == Format::big) std::reverse(bytes.begin(), bytes.end());
    left_.remove_prefix(sizeof(T));
    return std::bit_cast<T>(bytes);
  }

  double next_word() {
    const std::size_t begin = std::min(left_.find_first_not_of(" \t\r\n"), left_.size());
    left_.remove_prefix(begin);
    const std::string_view word = left_.substr(0, left_.find_first_of(" \t\r\n"));
    if (word.empty()) refuse_end();
    double value = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), value);
    if (error != std::errc() || end != word.data() + word.size())
      throw InputError(file_, fmt::format("'{}' is no number", word.substr(0, 40)), ply::kAccepted);
    left_.remove_prefix(word.size());
    return value;
  }

  std::string_view left_;
  Format format_;
  const std::string& file_;
};

// A whole number is a share of the largest of its kind.
float share(double value, Type type) {
  if (type == Type::uint8) return static_cast<float>(value / 255);
  if (type == Type::uint16) return static_cast<float>(value / 65535);
  return static_cast<float>(value);
}

class Reader {
 public:
  Reader(const std::filesystem::path& file, const std::string& name, const ImportLimits& limits)
      : file_(file), name_(name), limits_(limits) {}

  Scene read(std::string_view bytes) {
    scene_.files = {name_};
    const ply::Header header = ply::read_header(bytes, name_);
    Numbers numbers(bytes.substr(header.size), header.format, name_);
    for (const Element& element : header.elements) read_element(element, numbers);
    check_triangles();
    scene_.name = mesh_.name = file_.stem().string();
    Material& material = scene_.materials.emplace_back();
    if (!mesh_.colors.empty()) material.base_color = Color(1);
    if (!header.picture.empty()) add_picture(material, header.picture);
    scene_.objects.emplace_back().name = mesh_.name;
    scene_.meshes.push_back(std::move(mesh_));
    scene_.instances.push_back({0, Matrix(), 0});
    return std::move(scene_);
  }

 private:
  void read_element(const Element& element, Numbers& numbers) {
    const bool vertices = element.name == "vertex", faces = element.name == "face";
    if (vertices)
      require_at_most(limits_.vertices, mesh_.positions.size() + element.count, "vertices", name_);
    if (!vertices && !faces && element.count > 0)
      warn(scene_, fmt::format("{}: the element '{}' is left out", name_, element.name));
    if (!element.properties.empty())
      for (std::uint64_t i = 0; i < element.count; ++i) {
        if (vertices)
          read_vertex(element, numbers);
        else
          read_other(element, numbers, faces);
      }
  }

  void read_vertex(const Element& element, Numbers& numbers) {
    Vec3 position(0), normal(0);
    Vec2 uv(0);
    std::array<float, 4> color{0, 0, 0, 1};
    bool has_normal = false, has_uv = false, has_color = false;
    for (const Property& p : element.properties) {
      if (p.count) {
        for (std::uint64_t left = numbers.length(p); left > 0; --left) numbers.next(p.type);
        continue;
      }
      const double value = numbers.next(p.type);
      const auto is = [&](std::initializer_list<std::string_view> names) {
        return std::find(names.begin(), names.end(), p.name) != names.end();
      };
      for (int c = 0; c < 3; ++c) {
        const char axis = static_cast<char>('x' + c);
        if (p.name == std::string(1, axis)) position[c] = static_cast<float>(value);
        if (p.name == std::string{'n', axis}) normal[c] = static_cast<float>(value), has_normal = true;
      }
      if (is({"u", "s", "texture_u"})) uv.x = static_cast<float>(value), has_uv = true;
      if (is({"v", "t", "texture_v"}))
        uv.y = static_cast<float>(1 - value), has_uv = true;  // v points up in PLY
      constexpr std::array<std::string_view, 3> kColors{"red", "green", "blue"};
      for (std::size_t c = 0; c < 3; ++c)
        if (p.name == kColors[c]) color[c] = from_srgb(share(value, p.type)), has_color = true;
      if (p.name == "alpha") color[3] = share(value, p.type);
    }
    mesh_.positions.push_back(position);
    if (has_normal) mesh_.normals.push_back(normal);
    if (has_uv) mesh_.uvs.push_back(uv);
    if (has_color) mesh_.colors.push_back(color);
  }

  void read_other(const Element& element, Numbers& numbers, bool faces) {
    for (const Property& p : element.properties) {
      const bool corners = faces && p.count && (p.name == "vertex_indices" || p.name == "vertex_index");
      std::array<double, 2> fan{};  // the first corner and the one before
      const std::uint64_t count = p.count ? numbers.length(p) : 1;
      for (std::uint64_t i = 0; i < count; ++i) {
        const double value = numbers.next(p.type);
        if (!corners) continue;
        if (i >= 2) add_triangle({fan[0], fan[1], value});
        fan[i == 0 ? 0 : 1] = value;
      }
    }
  }

  void add_triangle(const std::array<double, 3>& corners) {
    require_at_most(limits_.triangles, mesh_.triangles.size() + 1, "triangles", name_);
    std::array<std::uint32_t, 3> triangle{};
    for (std::size_t c = 0; c < 3; ++c) {
      if (!(corners[c] >= 0 && corners[c] < 4294967296.0))
        throw InputError(name_, fmt::format("a face uses vertex {}", corners[c]), "0 and above");
      triangle[c] = static_cast<std::uint32_t>(corners[c]);
    }
    mesh_.triangles.push_back(triangle);
  }

  // Vertices may come after the faces that use them.
  void check_triangles() const {
    for (const auto& triangle : mesh_.triangles)
      for (const std::uint32_t v : triangle)
        if (v >= mesh_.positions.size())
          throw InputError(name_, fmt::format("a face uses vertex {} of {}", v, mesh_.positions.size()));
  }

  void add_picture(Material& material, const std::string& picture) {
    PictureShelf shelf(scene_, limits_.roots);
    material.base_color = Color(1);
    material.base_color_texture.picture = shelf.place(file_.parent_path() / picture, Encoding::srgb, name_);
    const Picture& placed = scene_.pictures.back();
    require_at_most(limits_.picture_pixels,
                    static_cast<std::uint64_t>(placed.width) * static_cast<std::uint64_t>(placed.height),
                    "pixels in all pictures", name_);
  }

  const std::filesystem::path& file_;
  const std::string& name_;
  const ImportLimits& limits_;
  Scene scene_;
  Mesh mesh_;
};

}  // namespace

Scene read_ply(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where) {
  const std::filesystem::path allowed = within(limits.roots, file, where);
  const std::string name = allowed.string(), bytes = read_file(allowed, limits.file_bytes, where);
  return Reader(allowed, name, limits).read(bytes);
}

}  // namespace tessera
