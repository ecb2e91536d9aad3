// SPDX-License-Identifier: Apache-2.0
#include "core/exr_parts.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/error.h"

namespace tessera {
namespace {

constexpr int kMaxWindowEdge = 65536;
constexpr int kMaxChannels = 1024;
constexpr std::size_t kLongestName = 255;  // OpenEXR cuts longer ones, and two may become one
// A constant picture shrinks to a few bytes a chunk; nothing that shrinks more is a picture.
constexpr std::int64_t kMaxExpansion = 1 << 16;
constexpr int kThreadsToRead = 0;  // beside the one that asks: files that are read may be anything

// A channel and where it lies.
struct Stored {
  int part = 0;
  std::string name;  // in its part
  ExrChannel channel;
};

std::string words_for(const Imf::Header& header, int part) {
  return header.hasName() ? fmt::format("part '{}'", header.name().c_str())
                          : fmt::format("part {}", part + 1);
}

// Window of a file, or an InputError unless it is one that a frame may have.
Region region_of(const std::string& file, const char* which, const Imath::Box2i& box) {
  const std::int64_t width = std::int64_t{box.max.x} - box.min.x + 1;
  const std::int64_t height = std::int64_t{box.max.y} - box.min.y + 1;
  constexpr int kFar = 1 << 30;  // coordinates with room for halos
  if (width < 1 || height < 1 || width > kMaxWindowEdge || height > kMaxWindowEdge ||
      std::min(box.min.x, box.min.y) < -kFar || std::max(box.max.x, box.max.y) > kFar)
    throw InputError(file, fmt::format("the {} window is {} x {} pixels", which, width, height),
                     fmt::format("1 to {} pixels an edge", kMaxWindowEdge));
  return {box.min.x, box.min.y, box.max.x + 1, box.max.y + 1};
}

void require_plausible(const std::string& file, const Region& data, const std::vector<Stored>& stored,
                       std::uintmax_t bytes, std::int64_t most_values) {
  if (stored.empty() || stored.size() > kMaxChannels)
    throw InputError(file, fmt::format("has {} channels", stored.size()),
                     fmt::format("1 to {}", kMaxChannels));
  const std::int64_t values = data.area() * static_cast<std::int64_t>(stored.size());
  const std::int64_t integers = data.area() * std::ranges::count_if(stored, [](const Stored& s) {
                                  return s.channel.type == ExrType::uint32;
                                });
  if (values + integers > most_values)  // for integers may be kept beside the floats
    throw InputError(file,
                     fmt::format("holds {} values{}", values, integers > 0 ? ", integers among them" : ""),
                     fmt::format("at most {}, an integer counting as two", most_values));
  if (static_cast<std::uintmax_t>(values / kMaxExpansion) > bytes)
    throw InputError(file, fmt::format("claims {} values in {} bytes", values, bytes), "a complete file");
}

// OpenEXR makes room for a whole tile.
void require_tiles(const std::string& file, const Imf::TileDescription& tile) {
  constexpr unsigned kMostEdge = 4096;
  if (tile.xSize < 1 || tile.ySize < 1 || tile.xSize > kMostEdge || tile.ySize > kMostEdge)
    throw InputError(file, fmt::format("has tiles of {} x {} pixels", tile.xSize, tile.ySize),
                     fmt::format("edges from 1 to {}", kMostEdge));
}

// One image is flat and has one data window.
void require_part_of_image(const std::string& file, const Imf::Header& header, int part,
                           const Imath::Box2i& window) {
  if (header.hasType() && Imf::isDeepData(header.type()))
    throw InputError(file, fmt::format("its {} is deep", words_for(header, part)), "flat images");
  const Imath::Box2i& own = header.dataWindow();
  const auto pixels = [](const Imath::Box2i& box) {
    return fmt::format("{} {} to {} {}", box.min.x, box.min.y, box.max.x, box.max.y);
  };
  if (own != window)
    throw InputError(file,
                     fmt::format("its {} covers pixels {}, the first part {}", words_for(header, part),
                                 pixels(own), pixels(window)),
                     "parts of one data window");
  if (header.hasTileDescription()) require_tiles(file, header.tileDescription());
}

ExrType type_of(Imf::PixelType type) {
  return type == Imf::HALF ? ExrType::half : type == Imf::UINT ? ExrType::uint32 : ExrType::float32;
}

// Renderers write layers as parts: the part's name is the layer's.
std::string name_in_image(const Imf::Header& header, int part, const std::string& channel) {
  if (part == 0 || channel.find('.') != channel.npos) return channel;
  const std::string layer = header.name().c_str();  // as far as OpenEXR would write it
  return layer.empty() ? channel : layer + '.' + channel;
}

void add_channels(const std::string& file, const Imf::Header& header, int part, std::vector<Stored>& to) {
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      throw InputError(file, fmt::format("channel '{}' is subsampled", it.name()), "one value a pixel");
    const std::string name = name_in_image(header, part, it.name());
    if (name.size() > kLongestName)
      throw InputError(file, fmt::format("its {} has a channel '{}'", words_for(header, part), name),
                       fmt::format("names of at most {} letters, the part's among them", kLongestName));
    to.push_back({part, it.name(), {name, type_of(it.channel().type)}});
  }
}

// Of all parts, sorted by their names in the image.
std::vector<Stored> stored_channels(const std::string& file, const Imf::MultiPartInputFile& parts) {
  std::vector<Stored> stored;
  for (int p = 0; p < parts.parts(); ++p) {
    require_part_of_image(file, parts.header(p), p, parts.header(0).dataWindow());
    add_channels(file, parts.header(p), p, stored);
  }
  const auto name = [](const Stored& s) -> const std::string& { return s.channel.name; };
  std::ranges::stable_sort(stored, {}, name);
  if (const auto twin = std::ranges::adjacent_find(stored, {}, name); twin != stored.end()) {
    const int second = std::next(twin)->part;
    throw InputError(
        file,
        fmt::format("its {} and {} both have a channel '{}'", words_for(parts.header(twin->part), twin->part),
                    words_for(parts.header(second), second), twin->channel.name),
        "another name for each, as LAYER.CHANNEL");
  }
  return stored;
}

// What says how a file is stored, not what is in it: a file written from it is stored in its own way.
bool is_structure(std::string_view name) {
  constexpr std::string_view kNames[] = {"type",       "name",          "chunkCount", "version",
                                         "channels",   "tiles",         "view",       "lineOrder",
                                         "dataWindow", "displayWindow", "preview",    "dwaCompressionLevel",
                                         "compression"};
  return std::ranges::find(kNames, name) != std::end(kNames);
}

// Where parts differ the first one counts.
void read_metadata(const Imf::Header& header, ExrImage& image, ExrAttributes& others) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (is_structure(name) || image.metadata.contains(name) || others.by_name.contains(name)) continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      image.metadata[name] = text->value();
    else if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute()))
      image.metadata[name] = real->value();
    else if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&it.attribute()))
      image.metadata[name] = whole->value();
    else
      others.by_name.emplace(name, it.attribute().copy());
  }
}

// Floats of a plane into which integers were read. What floats do not hold is kept beside them.
void convert_integers(ExrImage& image, std::size_t p) {
  const auto plane = image.pixels.plane(static_cast<int>(p));
  std::vector<std::uint32_t> integers(plane.size());
  std::memcpy(integers.data(), plane.data(), plane.size_bytes());
  std::ranges::transform(integers, plane.begin(), [](std::uint32_t i) { return static_cast<float>(i); });
  const auto same = [](std::uint32_t i, float v) { return static_cast<double>(v) == i; };
  if (!std::ranges::equal(integers, plane, same))
    image.integers[image.channels[p].name] =
        std::make_shared<const std::vector<std::uint32_t>>(std::move(integers));
}

void read_pixels(Imf::MultiPartInputFile& parts, int p, const std::vector<Stored>& stored, ExrImage& image) {
  const Imath::Box2i& window = parts.header(p).dataWindow();
  Imf::FrameBuffer buffer;
  for (std::size_t i = 0; i < stored.size(); ++i) {
    if (stored[i].part != p) continue;
    const auto type = stored[i].channel.type == ExrType::uint32 ? Imf::UINT : Imf::FLOAT;
    buffer.insert(stored[i].name,
                  Imf::Slice::Make(type, image.pixels.plane(static_cast<int>(i)).data(), window));
  }
  Imf::InputPart part(parts, p);
  part.setFrameBuffer(buffer);
  part.readPixels(window.min.y, window.max.y);
  parts.flushPartCache();  // or the buffers of all parts would be there at once
}

}  // namespace

ExrImage read_exr_parts(const std::string& file, std::uintmax_t bytes, std::int64_t most_values) {
  Imf::MultiPartInputFile parts(file.c_str(), kThreadsToRead);
  ExrImage image;
  image.display = region_of(file, "display", parts.header(0).displayWindow());
  const Region data = region_of(file, "data", parts.header(0).dataWindow());
  const std::vector<Stored> stored = stored_channels(file, parts);
  require_plausible(file, data, stored, bytes, most_values);
  for (const Stored& s : stored) image.channels.push_back(s.channel);
  auto others = std::make_shared<ExrAttributes>();
  for (int p = 0; p < parts.parts(); ++p) read_metadata(parts.header(p), image, *others);
  image.others = std::move(others);
  image.pixels = Image(data, static_cast<int>(stored.size()));
  for (int p = 0; p < parts.parts(); ++p) read_pixels(parts, p, stored, image);
  for (std::size_t i = 0; i < stored.size(); ++i)
    if (stored[i].channel.type == ExrType::uint32) convert_integers(image, i);
  return image;
}

}  // namespace tessera
