// SPDX-License-Identifier: Apache-2.0
#include "core/exr.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfIO.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfThreading.h>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <fstream>
#include <limits>
#include <list>
#include <set>
#include <thread>

#include "core/error.h"
#include "core/exr_header.h"
#include "core/exr_parts.h"
#include "core/pending_file.h"

namespace tessera {

namespace {

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
  if (image.others)  // also in place of what OpenEXR puts into each header
    for (const auto& [name, attribute] : image.others->by_name)
      if (!image.metadata.contains(name)) header.insert(name, *attribute);
  for (const ExrChannel& c : image.channels)
    header.channels().insert(c.name, Imf::Channel(c.type == ExrType::half     ? Imf::HALF
                                                  : c.type == ExrType::uint32 ? Imf::UINT
                                                                              : Imf::FLOAT));
  return header;
}

half to_half(float v) { return half(std::isinf(v) ? v : std::clamp(v, -kHalfMax, kHalfMax)); }

std::uint32_t to_uint(float v) {
  constexpr float kBeyond = 4294967296.0f;
  if (!(v > 0)) return 0;
  return v < kBeyond ? static_cast<std::uint32_t>(std::nearbyint(v))
                     : std::numeric_limits<std::uint32_t>::max();
}

// The exact integers of a plane where it still is what they are as floats: then they are not another
// picture's, and nobody has changed the plane. Elsewhere its values, rounded.
std::vector<std::uint32_t> integers_of(const ExrImage& image, int p) {
  const auto plane = image.pixels.plane(p);
  const auto at = image.integers.find(image.channels[static_cast<std::size_t>(p)].name);
  const bool known = at != image.integers.end() && at->second && at->second->size() == plane.size();
  std::vector<std::uint32_t> integers(plane.size());
  for (std::size_t i = 0; i < plane.size(); ++i) {
    const std::uint32_t exact = known ? (*at->second)[i] : 0;
    integers[i] = known && static_cast<float>(exact) == plane[i] ? exact : to_uint(plane[i]);
  }
  return integers;
}

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

void write_pixels(Imf::OutputFile& out, const ExrImage& image) {
  const Imath::Box2i box = window(image.pixels.region());
  const std::size_t area = static_cast<std::size_t>(image.pixels.region().area());
  std::vector<half> halves;
  halves.reserve(area * std::ranges::count(image.channels, ExrType::half, &ExrChannel::type));
  std::list<std::vector<std::uint32_t>> integers;
  Imf::FrameBuffer buffer;
  for (int p = 0; p < image.pixels.planes(); ++p) {
    const auto plane = image.pixels.plane(p);
    const ExrChannel& channel = image.channels[p];
    if (channel.type == ExrType::half) {
      half* first = halves.data() + halves.size();
      for (float v : plane) halves.push_back(to_half(v));
      buffer.insert(channel.name, Imf::Slice::Make(Imf::HALF, first, box));
    } else if (channel.type == ExrType::uint32) {
      const auto& whole = integers.emplace_back(integers_of(image, p));
      buffer.insert(channel.name, Imf::Slice::Make(Imf::UINT, whole.data(), box));
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

// The first bytes of a file of so many.
std::string start_of(const std::filesystem::path& file, std::uintmax_t bytes) {
  std::string start(bytes, '\0');
  std::ifstream in(file, std::ios::binary);
  in.read(start.data(), static_cast<std::streamsize>(start.size()));
  start.resize(static_cast<std::size_t>(in.gcount()));
  return start;
}

// Looks at all of the headers, however long: what nobody has looked at OpenEXR would trust.
void require_honest_headers(const std::filesystem::path& file, std::uintmax_t bytes) {
  constexpr std::uintmax_t kUsual = 1 << 20, kMost = 1 << 28;
  for (std::uintmax_t part = kUsual;; part *= 4) {
    switch (exr_headers(start_of(file, std::min(part, bytes)), bytes, 0)) {
      case ExrHeaders::fit:
        return;
      case ExrHeaders::lie:
        throw InputError(file.string(), "its header promises more than it holds", "a complete OpenEXR file");
      case ExrHeaders::too_many:
        throw InputError(file.string(), "has too many parts", fmt::format("1 to {}", kMostExrParts));
      case ExrHeaders::longer:
        if (part >= std::min(kMost, bytes))
          throw InputError(file.string(), "its headers do not end",
                           fmt::format("at most {} bytes of them", kMost));
    }
  }
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
  require_honest_headers(file, bytes);
  try {
    return read_exr_parts(file.string(), bytes, most_values);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {  // OpenEXR's, and what a corrupt file makes it meet
    throw InputError(file.string(), fmt::format("cannot be read: {}", e.what()), "a complete OpenEXR file");
  }
}

}  // namespace tessera
