// SPDX-License-Identifier: Apache-2.0
#include "core/exr.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <fstream>
#include <set>
#include <thread>

#include "core/error.h"
#include "core/exr_header.h"
#include "core/pending_file.h"

namespace tessera {

struct ExrAttributes {
  Imf::Header header;
};

namespace {

constexpr int kMaxWindowEdge = 65536;
constexpr int kMaxChannels = 1024;
// A constant picture shrinks to a few bytes a chunk; nothing that shrinks more is a picture.
constexpr std::int64_t kMaxExpansion = 1 << 16;
constexpr float kHalfMax = 65504.0f;
// Of zip and zips: two thirds of the time of OpenEXR's 4 for 2 % more bytes (28 layers of a frame,
// docs/BENCHMARKS.md).
constexpr int kZipLevel = 2;

Imath::Box2i window(const Region& r) { return {{r.x0, r.y0}, {r.x1 - 1, r.y1 - 1}}; }

Imf::Compression compression_of(const std::string& name) {
  const auto& names = exr_compressions();
  const auto it = std::find(names.begin(), names.end(), name);
  if (it == names.end())
    throw InputError("compression", "'" + name + "' is unknown", fmt::format("{}", fmt::join(names, " ")));
  return static_cast<Imf::Compression>(it - names.begin());
}

void require_distinct_names(const std::filesystem::path& file, const std::vector<ExrChannel>& channels) {
  std::set<std::string_view> names;
  for (const ExrChannel& c : channels)
    if (c.name.empty() || !names.insert(c.name).second)
      throw InputError(file.string(), "channel '" + c.name + "' is unnamed or there twice");
}

Imf::Header header_of(const ExrImage& image, Imf::Compression compression) {
  const Region display = image.display.empty() ? image.pixels.region() : image.display;
  Imf::Header header(window(display), window(image.pixels.region()));
  header.compression() = compression;
  header.zipCompressionLevel() = kZipLevel;
  for (const auto& [name, value] : image.metadata) {
    if (const auto* text = std::get_if<std::string>(&value))
      header.insert(name, Imf::StringAttribute(*text));
    else if (const auto* number = std::get_if<float>(&value))
      header.insert(name, Imf::FloatAttribute(*number));
    else
      header.insert(name, Imf::IntAttribute(std::get<int>(value)));
  }
  if (image.others)
    for (auto it = image.others->header.begin(); it != image.others->header.end(); ++it)
      if (header.find(it.name()) == header.end()) header.insert(it.name(), it.attribute());
  for (const ExrChannel& c : image.channels)
    header.channels().insert(c.name, Imf::Channel(c.half ? Imf::HALF : Imf::FLOAT));
  return header;
}

half to_half(float v) { return half(v > kHalfMax ? kHalfMax : v < -kHalfMax ? -kHalfMax : v); }

// Packing is most of what writing takes. Files that are read may be anything: one thread each.
int threads_to_write() {
  static constexpr unsigned kMost = 8;
  static const int threads = [] {
    const int cores = static_cast<int>(std::min(std::thread::hardware_concurrency(), kMost));
    if (cores > Imf::globalThreadCount()) Imf::setGlobalThreadCount(cores);
    return cores;
  }();
  return threads;
}
constexpr int kThreadsToRead = 0;  // beside the one that asks

void write_pixels(Imf::OutputFile& out, const ExrImage& image) {
  const Imath::Box2i box = window(image.pixels.region());
  const std::size_t area = static_cast<std::size_t>(image.pixels.region().area());
  std::vector<half> halves;
  halves.reserve(area * std::ranges::count_if(image.channels, &ExrChannel::half));
  Imf::FrameBuffer buffer;
  for (int p = 0; p < image.pixels.planes(); ++p) {
    const auto plane = image.pixels.plane(p);
    const ExrChannel& channel = image.channels[p];
    if (channel.half) {
      half* first = halves.data() + halves.size();
      for (float v : plane) halves.push_back(to_half(v));
      buffer.insert(channel.name, Imf::Slice::Make(Imf::HALF, first, box));
    } else {
      buffer.insert(channel.name, Imf::Slice::Make(Imf::FLOAT, plane.data(), box));
    }
  }
  out.setFrameBuffer(buffer);
  out.writePixels(image.pixels.region().height());
}

// A file in memory.
class Bytes : public Imf::OStream {
 public:
  Bytes() : Imf::OStream("memory") {}
  void write(const char from[], int n) override {
    if (at_ + static_cast<std::size_t>(n) > bytes_.size()) bytes_.resize(at_ + static_cast<std::size_t>(n));
    std::copy_n(from, n, bytes_.begin() + static_cast<std::ptrdiff_t>(at_));
    at_ += static_cast<std::size_t>(n);
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t to) override { at_ = to; }
  std::string taken() && { return std::move(bytes_); }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

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

void require_plausible(const std::string& file, const Region& data, std::size_t channels,
                       std::uintmax_t bytes, std::int64_t most_values) {
  if (channels < 1 || channels > kMaxChannels)
    throw InputError(file, fmt::format("has {} channels", channels), fmt::format("1 to {}", kMaxChannels));
  const std::int64_t values = data.area() * static_cast<std::int64_t>(channels);
  if (values > most_values)
    throw InputError(file, fmt::format("holds {} values", values), fmt::format("at most {}", most_values));
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

std::vector<ExrChannel> channels_of(const std::string& file, const Imf::Header& header) {
  std::vector<ExrChannel> channels;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it) {
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1)
      throw InputError(file, fmt::format("channel '{}' is subsampled", it.name()), "one value a pixel");
    channels.push_back({it.name(), it.channel().type == Imf::HALF});
  }
  return channels;
}

// What says how a file is stored, not what is in it: a file written from it is stored in its own way.
bool is_structure(std::string_view name) {
  constexpr std::string_view kNames[] = {"type",       "name",          "chunkCount", "version",
                                         "channels",   "tiles",         "view",       "lineOrder",
                                         "dataWindow", "displayWindow", "preview",    "dwaCompressionLevel",
                                         "compression"};
  return std::ranges::find(kNames, name) != std::end(kNames);
}

void read_metadata(const Imf::Header& header, ExrImage& image) {
  auto others = std::make_shared<ExrAttributes>();
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (is_structure(name)) continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute()))
      image.metadata[name] = text->value();
    else if (const auto* real = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute()))
      image.metadata[name] = real->value();
    else if (const auto* whole = dynamic_cast<const Imf::IntAttribute*>(&it.attribute()))
      image.metadata[name] = whole->value();
    else
      others->header.insert(name, it.attribute());
  }
  image.others = std::move(others);
}

// Enough of a file for its headers.
std::string start_of(const std::filesystem::path& file) {
  std::string start(std::size_t{1} << 20, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

ExrImage read(const std::string& file, std::uintmax_t bytes, std::int64_t most_values) {
  Imf::MultiPartInputFile parts(file.c_str(), kThreadsToRead);
  const Imf::Header& header = parts.header(0);
  if (header.hasType() && Imf::isDeepData(header.type()))
    throw InputError(file, "its first part is deep", "flat images");
  ExrImage image;
  image.display = region_of(file, "display", header.displayWindow());
  const Region data = region_of(file, "data", header.dataWindow());
  image.channels = channels_of(file, header);
  require_plausible(file, data, image.channels.size(), bytes, most_values);
  if (header.hasTileDescription()) require_tiles(file, header.tileDescription());
  read_metadata(header, image);
  image.pixels = Image(data, static_cast<int>(image.channels.size()));
  Imf::FrameBuffer buffer;
  for (int p = 0; p < image.pixels.planes(); ++p)
    buffer.insert(image.channels[p].name,
                  Imf::Slice::Make(Imf::FLOAT, image.pixels.plane(p).data(), header.dataWindow()));
  Imf::InputPart part(parts, 0);
  part.setFrameBuffer(buffer);
  part.readPixels(data.y0, data.y1 - 1);
  return image;
}

}  // namespace

int ExrImage::plane(std::string_view channel) const {
  const auto it = std::ranges::find(channels, channel, &ExrChannel::name);
  return it == channels.end() ? -1 : static_cast<int>(it - channels.begin());
}

// In the order of Imf::Compression.
const std::vector<std::string>& exr_compressions() {
  static const std::vector<std::string> names{"none",  "rle", "zips", "zip",  "piz",
                                              "pxr24", "b44", "b44a", "dwaa", "dwab"};
  return names;
}

void write_exr(const std::filesystem::path& file, const ExrImage& image, const std::string& compression) {
  assert(!image.pixels.empty() && image.channels.size() == static_cast<std::size_t>(image.pixels.planes()));
  const Imf::Compression how = compression_of(compression);
  require_distinct_names(file, image.channels);
  PendingFile pending(file);
  try {
    {
      Imf::OutputFile out(pending.temporary().c_str(), header_of(image, how), threads_to_write());
      write_pixels(out, image);
    }
    pending.commit();
  } catch (const std::exception& e) {
    throw InputError(file.string(), fmt::format("cannot be written: {}", e.what()), "a writable folder");
  }
}

std::string exr_bytes(const ExrImage& image, const std::string& compression) {
  assert(!image.pixels.empty() && image.channels.size() == static_cast<std::size_t>(image.pixels.planes()));
  const Imf::Compression how = compression_of(compression);
  require_distinct_names("an EXR in memory", image.channels);
  Bytes bytes;
  {
    Imf::OutputFile out(bytes, header_of(image, how), threads_to_write());
    write_pixels(out, image);
  }
  return std::move(bytes).taken();
}

ExrImage read_exr(const std::filesystem::path& file, std::int64_t most_values) {
  std::error_code missing;
  const std::uintmax_t bytes = std::filesystem::file_size(file, missing);
  if (missing) throw InputError(file.string(), missing.message(), "an OpenEXR file");
  if (!exr_header_fits(start_of(file), bytes, 0))
    throw InputError(file.string(), "its header promises more than it holds", "a complete OpenEXR file");
  try {
    return read(file.string(), bytes, most_values);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {  // OpenEXR's, and what a corrupt file makes it meet
    throw InputError(file.string(), fmt::format("cannot be read: {}", e.what()), "a complete OpenEXR file");
  }
}

}  // namespace tessera
