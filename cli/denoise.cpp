// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <ostream>
#include <set>

#include "cli/sizes.h"
#include "cli/version.h"
#include "core/error.h"
#include "core/exr.h"
#include "core/filter/gather.h"
#include "core/job.h"
#include "core/layers.h"
#include "core/png.h"
#include "core/sequence.h"
#include "worker/denoise/runner.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

constexpr int kLeastTile = 16;

[[noreturn]] void refuse(std::string_view option, std::string_view value, std::string_view accepted) {
  throw Error(ExitCode::bad_usage,
              fmt::format("{}: '{}' is not accepted; accepted: {}", option, value, accepted));
}

// "albedo=albedo.####.exr"
struct Guide {
  std::string layer, file;
};

std::vector<Guide> guides_of(const DenoiseOptions& o) {
  std::vector<Guide> guides;
  for (const std::string& text : o.guides) {
    const std::size_t sign = text.find('=');
    if (sign == 0 || sign == std::string::npos || sign + 1 == text.size())
      refuse("--guide", text, "LAYER=FILE, as in albedo=shot_albedo.exr");
    guides.push_back({text.substr(0, sign), text.substr(sign + 1)});
  }
  return guides;
}

std::uint64_t bytes_of(const FilterPlan& plan, const Region& frame, Size tile) {
  const int halo = plan.halo();
  const double width = std::min(tile.width + 2 * halo, frame.width());
  const double height = std::min(tile.height + 2 * halo, frame.height());
  const double floats =
      static_cast<double>(plan.inputs().size()) + plan.description().scratch(plan.parameters) + 3;
  return static_cast<std::uint64_t>(width * height * floats * sizeof(float));
}

Size tile_of(const DenoiseOptions& o, const FilterPlan& plan, const Region& frame) {
  if (o.tile_size.empty()) return tile_within(plan, frame, o.memory << 20);
  const std::optional<Size> tile = parse_tile_size(o.tile_size);
  if (!tile) refuse("--tile-size", o.tile_size, fmt::format("N or WxH, each 1 to {}", kMaxEdge));
  return *tile;
}

Image filtered(Device& device, const FilterPlan& plan, const Image& input, Size tile) {
  Image whole(input.region(), 3);
  for (const Tile& t : tiles_over(input.region(), tile, plan.halo()))
    paste(whole, filter(device, plan, cropped(input, t.outer), t, input.region()));
  return whole;
}

// How many pixels of each layer are not finite, and where the first one is: they come out black, or are no
// guide.
std::vector<std::string> broken(const FilterPlan& plan, const Image& input) {
  std::vector<std::string> notices;
  const std::vector<Channel> channels = plan.inputs();
  const Region& r = input.region();
  for (std::size_t k = 0; k < channels.size(); ++k) {
    const auto plane = input.plane(static_cast<int>(k));
    const auto bad = [](float v) { return !std::isfinite(v); };
    const auto count = std::ranges::count_if(plane, bad);
    if (count == 0) continue;
    const auto first = std::ranges::find_if(plane, bad) - plane.begin();
    notices.push_back(fmt::format("{}: {} pixel{} not finite, the first at ({}, {})",
                                  file_channel(channels[k]), count, count == 1 ? " is" : "s are",
                                  r.x0 + first % r.width(), r.y0 + first / r.width()));
  }
  return notices;
}

// The picture with its R, G and B replaced. What was said of the old ones' error is not true of the new ones.
ExrImage delivered(const ExrImage& picture, const Image& rgb, const FilterPlan& plan) {
  ExrImage out = picture;
  for (const char* key : {"tessera/error", "tessera/relmse", "tessera/relmse_upper"}) out.metadata.erase(key);
  out.metadata["tessera/filter"] = to_string(plan);
  out.metadata["tessera/version"] = std::string(kVersion);
  std::vector<float> data;
  out.channels.clear();
  for (std::size_t p = 0; p < picture.channels.size(); ++p) {
    const std::string& name = picture.channels[p].name;
    if (name == "R" || name == "G" || name == "B" || name == "error.Y") continue;
    out.channels.push_back(picture.channels[p]);
    const auto plane = picture.pixels.plane(static_cast<int>(p));
    data.insert(data.end(), plane.begin(), plane.end());
  }
  for (int c = 0; c < 3; ++c) {
    const int old = picture.plane(std::string(1, "RGB"[c]));
    out.channels.push_back(
        {std::string(1, "RGB"[c]), old < 0 || picture.channels[static_cast<std::size_t>(old)].half});
    data.insert(data.end(), rgb.plane(c).begin(), rgb.plane(c).end());
  }
  out.pixels = Image(rgb.region(), static_cast<int>(out.channels.size()), std::move(data));
  return out;
}

void require_other_file(const fs::path& in, const fs::path& out) {
  std::error_code none;
  if (fs::equivalent(in, out, none))
    throw Error(ExitCode::bad_usage, fmt::format("--output: '{}' is the input itself", out.string()));
}

class Denoiser {
 public:
  Denoiser(const DenoiseOptions& o, std::ostream& out, std::ostream& problems)
      : o_(o), out_(out), problems_(problems), plan_(parse_filter(o.filter)), guides_(guides_of(o)) {
    if (o.samples && !(*o.samples >= 1 && *o.samples <= 1e9))
      refuse("--samples", fmt::format("{}", *o.samples), "1 to 1e9");
    device_ = Device::open(o.device);
  }

  // `frame` replaces the places for numbers; none: there are none.
  void run(std::optional<int> frame) {
    const auto begin = std::chrono::steady_clock::now();
    const auto named = [&](const fs::path& p) { return frame && is_pattern(p) ? file_of(p, *frame) : p; };
    const fs::path in = named(o_.input), to = named(o_.output);
    require_other_file(in, to);
    const ExrImage picture = read_exr(in);
    Sources sources{&picture, {}, o_.samples};
    for (const Guide& g : guides_) sources.separate.emplace(g.layer, read_exr(named(g.file)));
    Gathered gathered = gather(plan_, sources, in.string());
    const FilterPlan plan = resolved(plan_, facts_of(plan_, gathered.input, sources));
    const Size tile = tile_of(o_, plan, gathered.input.region());
    const Image rgb = filtered(*device_, plan, gathered.input, tile);
    const ExrImage image = delivered(picture, rgb, plan);
    write_exr(to, image, o_.compression);
    write_png(fs::path(to).replace_extension(".png"), rgb, static_cast<float>(o_.exposure));
    for (const std::string& notice : gathered.notices) say(notice);
    for (const std::string& notice : broken(plan, gathered.input))
      problems_ << "tessera: " << in.string() << ": " << notice << '\n';
    if (o_.quiet) return;
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
    out_ << fmt::format("{}: {} in tiles of {}x{}, {:.2f} s\n", to.string(), to_string(plan), tile.width,
                        tile.height, seconds);
  }

 private:
  // The same for all frames: once is enough.
  void say(const std::string& notice) {
    if (said_.insert(notice).second) problems_ << "tessera: " << notice << '\n';
  }

  const DenoiseOptions& o_;
  std::ostream &out_, &problems_;
  FilterPlan plan_;
  std::vector<Guide> guides_;
  std::unique_ptr<Device> device_;
  std::set<std::string> said_;
};

std::vector<int> frames_of(const DenoiseOptions& o) {
  if (!is_pattern(o.output))
    refuse("--output", o.output, "a name with #### or %04d, as the input is a sequence");
  if (!o.frames.empty()) return parse_frames(o.frames);
  std::vector<int> frames = frames_there(o.input);
  if (frames.empty())
    throw InputError(o.input, "no file of that pattern is there", "a sequence of EXR files");
  return frames;
}

}  // namespace

void describe(CLI::App& app, DenoiseOptions& o) {
  app.add_option("input", o.input,
                 "EXR with the noisy image and its guides, of any renderer; with #### or %04d a sequence")
      ->required();
  app.add_option("-o,--output", o.output,
                 "EXR to write, with all other layers of the input; a PNG preview goes beside it")
      ->required();
  app.add_option("--frames", o.frames, "Of a sequence: 1-60, 1-100x2,150 [all that are there]");
  app.add_option("--filter", o.filter, "Denoiser, e.g. nlm, svgf:sigma_l=2 (see tessera filters)")
      ->envname("TESSERA_FILTER")
      ->capture_default_str();
  app.add_option("--guide", o.guides,
                 "LAYER=FILE: a layer in a file of its own, e.g. albedo=shot.albedo.exr");
  app.add_option("--samples", o.samples, "Per pixel, where the file does not say");
  app.add_option("--tile-size", o.tile_size,
                 "N or WxH pixels; does not change the image [as --memory allows]")
      ->envname("TESSERA_TILE_SIZE");
  app.add_option("--memory", o.memory, "MiB that a tile may take; the image itself is held besides")
      ->check(CLI::Range(std::uint64_t{1}, std::uint64_t{1} << 24))
      ->capture_default_str();
  app.add_option("--device", o.device, "OpenCL device: number or part of its name [first CPU]")
      ->envname("TESSERA_DEVICE");
  app.add_option("--compression", o.compression, "Of the EXR")
      ->check(CLI::IsMember(exr_compressions()))
      ->envname("TESSERA_COMPRESSION")
      ->capture_default_str();
  app.add_option("--exposure", o.exposure, "Stops, of the PNG preview only")
      ->check(CLI::Range(-100.0, 100.0))
      ->capture_default_str();
  app.add_flag("--quiet", o.quiet, "Only problems");
}

int denoise(const DenoiseOptions& o, std::ostream& out, std::ostream& problems) {
  Denoiser denoiser(o, out, problems);
  if (!is_pattern(o.input)) {
    if (!o.frames.empty())
      refuse("--frames", o.frames, "only with an input that has #### or %04d in its name");
    denoiser.run(std::nullopt);
    return 0;
  }
  ExitCode worst = ExitCode::done;
  for (const int frame : frames_of(o)) try {
      denoiser.run(frame);
    } catch (const Error& e) {
      if (e.code() == ExitCode::bad_usage) throw;
      problems << "tessera: frame " << frame << ": " << e.what() << '\n';
      worst = e.code();
    }
  return static_cast<int>(worst);
}

Size tile_within(const FilterPlan& plan, const Region& frame, std::uint64_t bytes) {
  Size tile{frame.width(), frame.height()};
  while (bytes_of(plan, frame, tile) > bytes) {
    int& longer = tile.width > tile.height ? tile.width : tile.height;
    if (longer <= kLeastTile)
      throw Error(
          ExitCode::out_of_memory,
          fmt::format("--memory: filter '{}' takes {} MiB for a tile of {}x{} with its halo of {}", plan.name,
                      (bytes_of(plan, frame, tile) >> 20) + 1, tile.width, tile.height, plan.halo()));
    longer = (longer + 1) / 2;
  }
  return tile;
}

}  // namespace tessera
