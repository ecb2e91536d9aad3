// SPDX-License-Identifier: Apache-2.0
#include "worker/render/texture_cache.h"

#include <OpenImageIO/imageio.h>
#include <OpenImageIO/texture.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <mutex>
#include <optional>
#include <vector>

#include "core/error.h"
#include "core/pending_file.h"
#include "core/scene/pictures.h"
#include "core/sha256.h"
#include "worker/render/mip_map.h"
#include "worker/render/texture_folder.h"

namespace tessera::tracer {
namespace {

namespace fs = std::filesystem;

constexpr int kVersion = 1;  // of the files: another number, other files
constexpr int kTile = 64;    // texels, the edge of what is read at once
constexpr float kLargestHalf = 65504.0f;

// The file's name says all that its content depends on.
std::string file_name(const Picture& p) {
  if (!p.digest.empty())
    return fmt::format("{}-{}-{}.exr", p.digest, p.encoding == Encoding::srgb ? "srgb" : "linear", kVersion);
  Sha256 hash;
  for (const int edge : {p.width, p.height, p.channels}) hash.add(&edge, sizeof edge);
  hash.add(p.pixels.data(), p.pixels.size() * sizeof(float));
  return fmt::format("{}-pixels-{}.exr", hash.hex(), kVersion);
}

OIIO::ImageSpec spec_of(const Picture& p, OIIO::TypeDesc type) {
  static const std::array<std::vector<std::string>, 4> kNames{
      {{"Y"}, {"Y", "A"}, {"R", "G", "B"}, {"R", "G", "B", "A"}}};
  OIIO::ImageSpec spec(p.width, p.height, p.channels, type);
  spec.channelnames = kNames[static_cast<std::size_t>(p.channels - 1)];
  spec.tile_width = spec.tile_height = kTile;
  spec.attribute("textureformat", "Plain Texture");
  spec.attribute("openexr:levelmode", 1);  // mip-mapped
  spec.attribute("compression", "zip");
  return spec;
}

[[noreturn]] void refuse_to_write(const fs::path& file, std::string_view why) {
  throw Error(ExitCode::internal_error, fmt::format("texture cache: {}: {}", file.string(), why));
}

void write_levels(Picture picture, OIIO::TypeDesc type, const fs::path& file) {
  const auto out = OIIO::ImageOutput::create("openexr");
  if (!out) refuse_to_write(file, OIIO::geterror());
  auto mode = OIIO::ImageOutput::Create;
  const int levels = mip_levels(picture);
  for (int level = 0; level < levels; ++level, mode = OIIO::ImageOutput::AppendMIPLevel) {
    if (level > 0) picture = half_size(picture);
    if (!out->open(file.string(), spec_of(picture, type), mode) ||
        !out->write_image(OIIO::TypeDesc::FLOAT, picture.pixels.data()))
      refuse_to_write(file, out->geterror());
  }
  if (!out->close()) refuse_to_write(file, out->geterror());
}

void convert(const Picture& picture, const fs::path& file) {
  Picture full = with_pixels(picture);
  const bool halves = !picture.digest.empty();
  if (halves)
    for (float& v : full.pixels) v = std::clamp(v, -kLargestHalf, kLargestHalf);
  PendingFile pending(file);
  write_levels(std::move(full), halves ? OIIO::TypeDesc::HALF : OIIO::TypeDesc::FLOAT, pending.temporary());
  try {
    pending.commit();
  } catch (const fs::filesystem_error& e) {
    refuse_to_write(file, e.what());
  }
}

OIIO::TextureOpt::Wrap as_wrap(Texture::Wrap wrap) {
  switch (wrap) {
    case Texture::Wrap::repeat:
      return OIIO::TextureOpt::WrapPeriodic;
    case Texture::Wrap::mirror:
      return OIIO::TextureOpt::WrapMirror;
    default:
      return OIIO::TextureOpt::WrapClamp;
  }
}

}  // namespace

class TextureCache::System {
 public:
  explicit System(const TextureOptions& o) : textures(OIIO::TextureSystem::create(false)), given_(o.folder) {
    textures->attribute("max_memory_MB", static_cast<float>(o.memory) / (1 << 20));
  }

  // The file's handle, or null if it does not hold the picture.
  OIIO::TextureSystem::TextureHandle* find(const fs::path& file, const Picture& p) {
    if (!fs::exists(file)) return nullptr;
    const OIIO::ustring name(file.string());
    std::array<int, 2> size{};
    int channels = 0;
    const bool known =
        textures->get_texture_info(name, 0, OIIO::ustring("resolution"),
                                   OIIO::TypeDesc(OIIO::TypeDesc::INT, 2), size.data()) &&
        textures->get_texture_info(name, 0, OIIO::ustring("channels"), OIIO::TypeInt, &channels);
    if (known && size == std::array{p.width, p.height} && channels == p.channels)
      return textures->get_texture_handle(name);
    textures->geterror();
    textures->invalidate(name);
    return nullptr;
  }

  const TextureFolder& folder() {
    std::call_once(begun_, [this] { folder_.emplace(given_); });
    return *folder_;
  }

  struct Destroy {
    void operator()(OIIO::TextureSystem* t) const { OIIO::TextureSystem::destroy(t); }
  };
  std::unique_ptr<OIIO::TextureSystem, Destroy> textures;

 private:
  fs::path given_;
  std::once_flag begun_;
  std::optional<TextureFolder> folder_;
};

TextureCache::TextureCache(const TextureOptions& options) : system_(std::make_unique<System>(options)) {}

TextureCache::~TextureCache() = default;

const std::string& TextureCache::warning() { return system_->folder().warning(); }

TextureCache::Image TextureCache::open(const Picture& picture) {
  const fs::path file = system_->folder().path() / file_name(picture);
  auto* handle = system_->find(file, picture);
  if (!handle) {
    convert(picture, file);
    handle = system_->find(file, picture);
    if (!handle) refuse_to_write(file, "what was written cannot be read");
  }
  const float width = static_cast<float>(picture.width), height = static_cast<float>(picture.height);
  return {handle, picture.channels, std::sqrt(width * height) / std::min(width, height)};
}

bool TextureCache::sample(const Image& image, Texture::Wrap u, Texture::Wrap v, const Footprint& at,
                          float* values, std::string& message) const {
  OIIO::TextureOpt options;
  options.swrap = as_wrap(u);
  options.twrap = as_wrap(v);
  options.mipmode = OIIO::TextureOpt::MipModeTrilinear;
  options.interpmode = OIIO::TextureOpt::InterpBilinear;
  OIIO::TextureSystem& textures = *system_->textures;
  const float width = at.width * image.scale;
  if (textures.texture(static_cast<OIIO::TextureSystem::TextureHandle*>(image.handle),
                       textures.get_perthread_info(), options, at.u, at.v, width, 0, 0, width, image.channels,
                       values))
    return true;
  message = textures.geterror();
  return false;
}

std::uint64_t TextureCache::memory_used() const {
  long long bytes = 0;
  system_->textures->getattribute("stat:cache_memory_used", OIIO::TypeInt64, &bytes);
  return static_cast<std::uint64_t>(bytes);
}

}  // namespace tessera::tracer
