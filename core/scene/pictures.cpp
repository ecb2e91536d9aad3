// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pictures.h"

#include <OpenImageIO/filesystem.h>
#include <OpenImageIO/imageio.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/error.h"
#include "core/exr_header.h"
#include "core/scene/bmp_header.h"
#include "core/scene/files.h"
#include "core/scene/roots.h"
#include "core/scene/srgb.h"
#include "core/sha256.h"

namespace tessera {
namespace {

constexpr std::array<std::string_view, 8> kExtensions{".png", ".jpg", ".jpeg", ".exr",
                                                      ".hdr", ".tif", ".tga",  ".bmp"};
constexpr std::string_view kFormats = "PNG, JPEG, OpenEXR, Radiance HDR, TIFF, Targa or BMP";
constexpr float kLargestHalf = 65504.0f;

// The format by the first bytes of a file: an embedded image has no name to go by.
std::string_view extension_by_content(std::string_view start) {
  if (start.starts_with("\x89PNG")) return ".png";
  if (start.starts_with("\xff\xd8\xff")) return ".jpg";
  if (start.starts_with("\x76\x2f\x31\x01")) return ".exr";
  if (start.starts_with("#?R")) return ".hdr";
  if (start.starts_with("BM")) return ".bmp";
  return {};
}

// Whether the last scan of a JPEG file has an end (ITU T.81, section B.1.1.3): libjpeg paints grey what is
// missing.
bool jpeg_ends(std::string_view bytes) {
  const std::size_t end = bytes.rfind("\xff\xd9"), scan = bytes.rfind("\xff\xda");
  return end != bytes.npos && (scan == bytes.npos || scan < end);
}

// What is wrong with a file that its library would trust; empty: nothing.
std::string unsound(std::string_view extension, std::string_view bytes) {
  if (extension == ".jpg" && !jpeg_ends(bytes)) return "the image ends early";
  if (extension == ".bmp" && !bmp_fits(bytes))
    return "the bitmap is compressed, or promises more than it holds";
  if (extension == ".exr" && !exr_header_fits(bytes, bytes.size(), kMaxPictureEdge))
    return fmt::format("the image promises more than it holds, or an edge of more than {} pixels",
                       kMaxPictureEdge);
  return {};
}

std::string reason(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text.empty() ? "the image cannot be read" : text;
}

void check_edges(int width, int height, int channels, std::string_view what, std::string_view where) {
  const auto edge_ok = [](int edge) { return edge >= 1 && edge <= kMaxPictureEdge; };
  const auto floats = static_cast<std::uint64_t>(std::max(width, 0)) *
                      static_cast<std::uint64_t>(std::max(height, 0)) *
                      static_cast<std::uint64_t>(std::max(channels, 0));
  if (!edge_ok(width) || !edge_ok(height) || floats > kMaxPictureFloats)
    throw InputError(
        where, fmt::format("{} is {} x {} x {}", what, width, height, channels),
        fmt::format("edges from 1 to {} and at most {} values", kMaxPictureEdge, kMaxPictureFloats));
}

void check_spec(const OIIO::ImageSpec& spec, std::string_view where) {
  check_edges(spec.width, spec.height, spec.nchannels, "the image", where);
  if (spec.tile_width > 0)
    check_edges(spec.tile_width, spec.tile_height, spec.nchannels, "a tile of the image", where);
  if (spec.depth > 1) throw InputError(where, fmt::format("the image has {} layers", spec.depth), "1");
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

// How many rows are read at a time.
int rows_of_band(const OIIO::ImageSpec& spec) {
  constexpr int kRows = 256;
  return spec.tile_width > 0 ? (kRows + spec.tile_height - 1) / spec.tile_height * spec.tile_height : kRows;
}

// Values of the type spec().format. UNKNOWN, where that means the same, makes OpenImageIO read them as they
// lie in the file; otherwise it takes 64 MiB whatever the size of the image.
bool read_rows(OIIO::ImageInput& input, int begin, int end, void* values) {
  const OIIO::ImageSpec& s = input.spec();
  const OIIO::TypeDesc type = s.channelformats.empty() ? OIIO::TypeDesc(OIIO::TypeDesc::UNKNOWN) : s.format;
  if (s.tile_width > 0)
    return input.read_tiles(0, 0, s.x, s.x + s.width, s.y + begin, s.y + end, s.z, s.z + 1, 0, s.nchannels,
                            type, values);
  return input.read_scanlines(0, 0, s.y + begin, s.y + end, s.z, 0, s.nchannels, type, values);
}

// All values, or none if only the source is kept. Band by band: rows that a file promises and does not have
// take no memory.
std::vector<float> read_values(OIIO::ImageInput& input, std::string_view where, Keep keep) {
  const OIIO::ImageSpec& spec = input.spec();
  const auto row = static_cast<std::size_t>(spec.width) * static_cast<std::size_t>(spec.nchannels);
  const int rows = std::min(rows_of_band(spec), spec.height);
  std::vector<char> band(row * static_cast<std::size_t>(rows) * spec.format.size());
  std::vector<float> values;
  if (keep == Keep::pixels) values.reserve(row * static_cast<std::size_t>(spec.height));
  for (int begin = 0, end = 0; begin < spec.height; begin = end) {
    end = std::min(begin + rows, spec.height);
    // Of a TIFF file that ends early only the error tells.
    if (!read_rows(input, begin, end, band.data()) || input.has_error())
      throw InputError(where, reason(input.geterror()), kFormats);
    if (keep == Keep::source) continue;
    const std::size_t old = values.size(), more = row * static_cast<std::size_t>(end - begin);
    values.resize(old + more);
    OIIO::convert_pixel_values(spec.format, band.data(), OIIO::TypeDesc::FLOAT, values.data() + old,
                               static_cast<int>(more));
  }
  return values;
}

Picture decode(OIIO::ImageInput& input, const std::string& name, Encoding encoding, std::string_view where,
               Keep keep) {
  const OIIO::ImageSpec& spec = input.spec();
  check_spec(spec, where);
  Picture picture{name, spec.width, spec.height, spec.nchannels, read_values(input, where, keep), encoding};
  if (encoding == Encoding::srgb && !spec.format.is_floating_point()) make_linear(picture);
  make_finite(picture);
  return picture;
}

// Bytes to read from. A place before the first one, where files may send a reader, OpenImageIO's own class
// takes for one after the last, and reads there.
class Memory : public OIIO::Filesystem::IOMemReader {
 public:
  explicit Memory(std::string_view bytes) : IOMemReader(const_cast<char*>(bytes.data()), bytes.size()) {}
  bool seek(std::int64_t offset) override { return offset >= 0 && IOMemReader::seek(offset); }
  std::size_t pread(void* to, std::size_t size, std::int64_t offset) override {
    const std::size_t most = this->size();
    return offset < 0 ? 0 : IOMemReader::pread(to, std::min(size, most), offset);
  }
};

OIIO::ImageSpec opening() {
  OIIO::ImageSpec config;
  config.attribute("oiio:UnassociatedAlpha", 1);  // colours as they are in the file, not times alpha
  return config;
}

// An image in memory; what its bytes do not tell is told by the extension of its name.
Picture decode_bytes(std::string_view bytes, const std::string& name, Encoding encoding,
                     std::string_view where, Keep keep) {
  std::string extension(extension_by_content(bytes));
  if (extension.empty()) extension = extension_of(name);
  if (std::find(kExtensions.begin(), kExtensions.end(), extension) == kExtensions.end())
    throw InputError(where, "this is no image we know", kFormats);
  if (const auto wrong = unsound(extension, bytes); !wrong.empty()) throw InputError(where, wrong, kFormats);
  try {
    Memory memory(bytes);
    OIIO::ImageSpec config = opening();
    OIIO::Filesystem::IOProxy* source = &memory;
    config.attribute("oiio:ioproxy", OIIO::TypeDesc::PTR, &source);
    const auto input = OIIO::ImageInput::open("image" + extension, &config);
    if (!input) throw InputError(where, reason(OIIO::geterror()), kFormats);
    Picture picture = decode(*input, name, encoding, where, keep);
    picture.digest = sha256(bytes);
    return picture;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    throw InputError(where, reason(e.what()), kFormats);
  }
}

// The number of a tile whose file is called `name`, or 0.
int udim_of(std::string_view name, std::string_view before, std::string_view after) {
  if (name.size() != before.size() + 4 + after.size() || !name.starts_with(before) || !name.ends_with(after))
    return 0;
  int number = 0;
  for (const char c : name.substr(before.size(), 4)) {
    if (c < '0' || c > '9') return 0;
    number = 10 * number + (c - '0');
  }
  return number > 1000 ? number : 0;
}

}  // namespace

Picture decode_picture(std::span<const unsigned char> bytes, const std::string& name, Encoding encoding,
                       Keep keep) {
  auto kept = std::make_shared<const std::string>(bytes.begin(), bytes.end());
  Picture picture = decode_bytes(*kept, name, encoding, name, keep);
  picture.bytes = std::move(kept);
  return picture;
}

Picture read_picture(const std::filesystem::path& file, Encoding encoding, std::string_view where,
                     Keep keep) {
  const std::string name = file.string();
  return decode_bytes(read_file(file, kMaxPictureBytes, where), name, encoding,
                      where.empty() ? name : fmt::format("{}: {}", where, name), keep);
}

Picture read_udims(const std::filesystem::path& pattern, Encoding encoding, std::string_view where) {
  const std::string name = pattern.filename().string();
  const std::size_t at = name.find(kUdim);
  Picture all;
  std::map<int, std::filesystem::path> files;
  std::error_code none;
  const std::filesystem::path folder = pattern.has_parent_path() ? pattern.parent_path() : ".";
  for (const auto& entry : std::filesystem::directory_iterator(folder, none))
    if (const int udim = udim_of(entry.path().filename().string(), std::string_view(name).substr(0, at),
                                 std::string_view(name).substr(at + kUdim.size())))
      files[udim] = entry.path();
  if (files.empty())
    throw InputError(where.empty() ? pattern.string() : where,
                     fmt::format("{}: there is no such file", pattern.string()),
                     "tiles with numbers from 1001 in place of <UDIM>");
  Sha256 digest;
  for (const auto& [udim, file] : files) {
    Picture& tile = all.tiles.emplace_back(read_picture(file, encoding, where, Keep::source));
    tile.udim = udim;
    digest.add(tile.digest.data(), tile.digest.size());
  }
  const Picture& first = all.tiles.front();
  all.name = pattern.string();
  all.width = first.width, all.height = first.height, all.channels = first.channels;
  all.encoding = encoding;
  all.digest = digest.hex();
  return all;
}

Picture with_pixels(const Picture& picture) {
  if (picture.digest.empty() || !picture.pixels.empty()) return picture;
  const auto bytes = picture.bytes
                         ? picture.bytes
                         : std::make_shared<const std::string>(read_file(picture.name, kMaxPictureBytes));
  if (sha256(*bytes) != picture.digest)
    throw InputError(picture.name, "the image is not the one that was loaded with the scene",
                     "files that stay as they are while they are rendered");
  Picture full = decode_bytes(*bytes, picture.name, picture.encoding, picture.name, Keep::pixels);
  full.bytes = picture.bytes;
  full.udim = picture.udim;
  return full;
}

template <class Decode>
int PictureShelf::place_once(const std::string& name, Encoding encoding, Keep keep, const Decode& decode_it) {
  const auto key = std::make_tuple(name, encoding, keep);
  if (const auto it = placed_.find(key); it != placed_.end()) return it->second;
  Picture picture = decode_it();
  const auto count = [&](const Picture& p) {
    bytes_ += p.pixels.size() * sizeof(float) + (p.bytes ? p.bytes->size() : 0);
    values_ += static_cast<std::uint64_t>(p.width) * p.height * p.channels;
  };
  count(picture);
  for (const Picture& tile : picture.tiles) count(tile);
  if (bytes_ > kMaxShelfBytes || values_ > kMaxShelfValues)
    throw InputError(name, "with this one the pictures hold too much",
                     fmt::format("{} bytes in memory and {} values in all", kMaxShelfBytes, kMaxShelfValues));
  scene_.pictures.push_back(std::move(picture));
  return placed_[key] = static_cast<int>(scene_.pictures.size()) - 1;
}

void PictureShelf::note(const Picture& picture, std::string_view where) {
  for (const Picture& tile : picture.tiles) note(tile, where);
  if (picture.tiles.empty()) scene_.files.push_back(within(roots_, picture.name, where).string());
}

int PictureShelf::place(const std::filesystem::path& named, Encoding encoding, std::string_view where,
                        Keep keep) {
  const std::filesystem::path file = within(roots_, named, where);
  return place_once(file.lexically_normal().string(), encoding, keep, [&] {
    const bool tiled = keep == Keep::source && file.filename().string().find(kUdim) != std::string::npos;
    Picture picture = tiled ? read_udims(file, encoding, where) : read_picture(file, encoding, where, keep);
    note(picture, where);
    return picture;
  });
}

int PictureShelf::place(std::span<const unsigned char> bytes, const std::string& name, Encoding encoding) {
  return place_once(name, encoding, Keep::source,
                    [&] { return decode_picture(bytes, name, encoding, Keep::source); });
}

}  // namespace tessera
