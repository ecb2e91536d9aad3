// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pictures.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/scene/files.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 8> kExtensions{".png", ".jpg", ".jpeg", ".exr",
                                                      ".hdr", ".tif", ".tga",  ".bmp"};
constexpr std::string_view kFormats = "PNG, JPEG, OpenEXR, Radiance HDR, TIFF, Targa or BMP";
constexpr float kLargestHalf = 65504.0f;

// IEC 61966-2-1:1999, section 5.2: the inverse of the sRGB transfer function.
float from_srgb(float v) { return v <= 0.04045f ? v / 12.92f : std::pow((v + 0.055f) / 1.055f, 2.4f); }

// The format by the first bytes of a file: an embedded image has no name to go by.
std::string_view extension_by_content(std::span<const unsigned char> bytes) {
  const std::string_view start(reinterpret_cast<const char*>(bytes.data()),
                               std::min<std::size_t>(bytes.size(), 16));
  if (start.starts_with("\x89PNG")) return ".png";
  if (start.starts_with("\xff\xd8\xff")) return ".jpg";
  if (start.starts_with("\x76\x2f\x31\x01")) return ".exr";
  if (start.starts_with("#?R")) return ".hdr";
  if (start.starts_with("BM")) return ".bmp";
  return {};
}

std::string reason(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "the image cannot be read" : text;
}

void check_spec(const OIIO::ImageSpec& spec, std::string_view where) {
  const auto edge_ok = [](int edge) { return edge >= 1 && edge <= kMaxPictureEdge; };
  const auto floats = static_cast<std::uint64_t>(std::max(spec.width, 0)) * std::max(spec.height, 0) *
                      static_cast<std::uint64_t>(std::max(spec.nchannels, 0));
  if (!edge_ok(spec.width) || !edge_ok(spec.height) || spec.depth > 1 || floats > kMaxPictureFloats)
    throw InputError(
        where, fmt::format("the image is {} x {} x {}", spec.width, spec.height, spec.nchannels),
        fmt::format("edges from 1 to {} and at most {} values", kMaxPictureEdge, kMaxPictureFloats));
  if (spec.nchannels < 1 || spec.nchannels > 4)
    throw InputError(where, fmt::format("the image has {} channels", spec.nchannels), "1 to 4");
}

// Channels of colour, before alpha.
int colour_channels(int channels) { return channels <= 2 ? 1 : 3; }

void make_linear(Picture& picture) {
  const int colours = colour_channels(picture.channels);
  for (std::size_t p = 0; p < picture.pixels.size(); p += static_cast<std::size_t>(picture.channels))
    for (int c = 0; c < colours; ++c) picture.pixels[p + c] = from_srgb(picture.pixels[p + c]);
}

void make_finite(Picture& picture) {
  for (float& v : picture.pixels)
    if (!std::isfinite(v)) v = std::isnan(v) ? 0.0f : std::copysign(kLargestHalf, v);
}

Picture decode(OIIO::ImageInput& input, const std::string& name, Encoding encoding, std::string_view where) {
  const OIIO::ImageSpec& spec = input.spec();
  check_spec(spec, where);
  Picture picture{name, spec.width, spec.height, spec.nchannels, {}};
  picture.pixels.resize(static_cast<std::size_t>(spec.width) * spec.height * spec.nchannels);
  if (!input.read_image(0, 0, 0, spec.nchannels, OIIO::TypeDesc::FLOAT, picture.pixels.data()))
    throw InputError(where, reason(input.geterror()), kFormats);
  if (encoding == Encoding::srgb && !spec.format.is_floating_point()) make_linear(picture);
  make_finite(picture);
  return picture;
}

OIIO::ImageSpec opening() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are in the file, not times alpha
  return config;
}

template <class Body>
Picture guarded(std::string_view where, const Body& body) {
  try {
    return body();
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(where, reason(e.what()), kFormats);
  }
}

Picture decode_as(std::span<const unsigned char> bytes, std::string_view extension, const std::string& name,
                  Encoding encoding, std::string_view where) {
  return guarded(where, [&] {
    OIIO::Filesystem::IOMemReader memory(const_cast<unsigned char*>(bytes.data()), bytes.size());
    OIIO::ImageSpec config = opening();
    OIIO::Filesystem::IOProxy* source = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &source);
    const auto input = OIIO::ImageInput::open("image" + std::string(extension), &config);
    if (!input) throw InputError(where, reason(OIIO::geterror()), kFormats);
    return decode(*input, name, encoding, where);
  });
}

}  // namespace

Picture decode_picture(std::span<const unsigned char> bytes, const std::string& name, Encoding encoding) {
  const std::string_view extension = extension_by_content(bytes);
  if (extension.empty()) throw InputError(name, "this is no image we know", kFormats);
  return decode_as(bytes, extension, name, encoding, name);
}

Picture read_picture(const std::filesystem::path& file, Encoding encoding, std::string_view where) {
  const std::string name = file.string();
  const std::string place = where.empty() ? name : fmt::format("{}: {}", where, name);
  const std::string bytes = read_file(file, kMaxPictureBytes, where);
  const std::span data(reinterpret_cast<const unsigned char*>(bytes.data()), bytes.size());
  const std::string_view content = extension_by_content(data);
  if (!content.empty()) return decode_as(data, content, name, encoding, place);
  const std::string extension = extension_of(file);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
    throw InputError(place, "this is no image we know", kFormats);
  return guarded(place, [&] {
    const OIIO::ImageSpec config = opening();
    const auto input = OIIO::ImageInput::open(name, &config);
    if (!input) throw InputError(place, reason(OIIO::geterror()), kFormats);
    return decode(*input, name, encoding, place);
  });
}

template <class Decode>
int PictureShelf::place_once(const std::string& name, Encoding encoding, const Decode& decode_it) {
  const auto key = std::make_pair(name, encoding);
  if (const auto it = placed_.find(key); it != placed_.end()) return it->second;
  Picture picture = decode_it();
  floats_ += picture.pixels.size();
  if (floats_ > kMaxShelfFloats)
    throw InputError(name, "with this one the pictures hold too much",
                     fmt::format("{} values in all", kMaxShelfFloats));
  scene_.pictures.push_back(std::move(picture));
  return placed_[key] = static_cast<int>(scene_.pictures.size()) - 1;
}

int PictureShelf::place(const std::filesystem::path& file, Encoding encoding, std::string_view where) {
  return place_once(file.lexically_normal().string(), encoding,
                    [&] { return read_picture(file, encoding, where); });
}

int PictureShelf::place(std::span<const unsigned char> bytes, const std::string& name, Encoding encoding) {
  return place_once(name, encoding, [&] { return decode_picture(bytes, name, encoding); });
}

}  // namespace tessera
