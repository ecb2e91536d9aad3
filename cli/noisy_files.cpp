// SPDX-License-Identifier: Apache-2.0
#include "cli/noisy_files.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <iterator>

#include "cli/picture_options.h"
#include "cli/version.h"
#include "core/error.h"
#include "core/layers.h"
#include "core/nearest.h"
#include "core/png.h"
#include "core/sequence.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

std::array<float, 2> parse_motion_scale(const std::string& text) {
  std::array<float, 2> scale;
  const char *at = text.data(), *const end = text.data() + text.size();
  for (std::size_t i = 0; i < 2; ++i) {
    const auto [behind, problem] = std::from_chars(at, end, scale[i]);
    const bool right_end = i == 0 ? behind != end && *behind == ',' : behind == end;
    if (problem != std::errc{} || !right_end || !std::isfinite(scale[i]) || scale[i] == 0)
      refuse_option("--motion-scale", text, "X,Y: two numbers that are not 0, as in -1,1");
    at = behind + 1;
  }
  return scale;
}

void require_other_file(const fs::path& in, const fs::path& out) {
  std::error_code none;
  if (fs::equivalent(in, out, none))
    throw Error(ExitCode::bad_usage, fmt::format("--output: '{}' is the input itself", out.string()));
}

// Of a single image the number that our files tell.
int number_in(const ExrImage& picture) {
  const int* number = picture.about<int>("tessera/frame");
  return number ? *number : 0;
}

// The picture with its R, G and B replaced. What was said of the old ones' error is not true of the new ones.
ExrImage delivered(const ExrImage& picture, const Image& rgb, const FilterPlan& plan) {
  ExrImage out = picture;
  for (const char* key : {"tessera/error", "tessera/relmse", "tessera/relmse_upper"}) out.metadata.erase(key);
  out.metadata["tessera/filter"] = to_string(plan);
  out.metadata["tessera/version"] = std::string(kVersion);
  Floats data;
  out.channels.clear();
  for (std::size_t p = 0; p < picture.channels.size(); ++p) {
    const std::string& name = picture.channels[p].name;
    if (name == "R" || name == "G" || name == "B" || name == "error.Y") continue;
    out.channels.push_back(picture.channels[p]);
    const auto plane = picture.pixels.plane(static_cast<int>(p));
    data.insert(data.end(), plane.begin(), plane.end());
  }
  for (int c = 0; c < 3; ++c) {
    const std::string name(1, "RGB"[c]);
    const int old = picture.plane(name);
    const ExrType type = old < 0 ? ExrType::half : picture.channels[static_cast<std::size_t>(old)].type;
    out.channels.push_back({name, type == ExrType::half ? type : ExrType::float32});
    data.insert(data.end(), rgb.plane(c).begin(), rgb.plane(c).end());
  }
  out.pixels = Image(rgb.region(), static_cast<int>(out.channels.size()), std::move(data));
  return out;
}

}  // namespace

NoisyFiles::NoisyFiles(const DenoiseOptions& o)
    : options_(o), plan_(parse_filter(o.filter)), guides_(guides_of(o)) {
  if (o.samples && !(*o.samples >= 1 && *o.samples <= 1e9))
    refuse_option("--samples", fmt::format("{}", *o.samples), "1 to 1e9");
  if (!o.motion_scale.empty()) motion_scale_ = parse_motion_scale(o.motion_scale);
}

std::vector<NoisyFiles::Guide> NoisyFiles::guides_of(const DenoiseOptions& o) {
  std::vector<Guide> guides;
  const std::vector<std::string> names = layer_names();
  const std::vector<std::string_view> known(names.begin(), names.end());
  for (const std::string& text : o.guides) {
    const std::size_t sign = text.find('=');
    if (sign == 0 || sign == std::string::npos || sign + 1 == text.size())
      refuse_option("--guide", text, "LAYER=FILE, as in albedo=shot_albedo.exr");
    const std::string layer = text.substr(0, sign);
    if (std::ranges::find(known, layer) == known.end())
      throw Error(ExitCode::bad_usage, fmt::format("--guide: {}; accepted: {}",
                                                   unknown("layer", layer, known), fmt::join(known, ", ")));
    if (std::ranges::find(guides, layer, &Guide::layer) != guides.end())
      refuse_option("--guide", text, "one file for each layer");
    if (is_pattern(o.input) && !is_pattern(text.substr(sign + 1)))
      refuse_option("--guide", text, "a name with #### or %04d, as the input is a sequence");
    guides.push_back({layer, text.substr(sign + 1)});
  }
  return guides;
}

void NoisyFiles::take_facts_of(const std::vector<int>& frames) {
  if (!asks_for_scene(plan_)) return;
  for (const int frame : frames) {
    try {
      facts_ = read(frame).facts;
      return;
    } catch (const Error& error) {  // is said when its turn comes
      if (error.code() == ExitCode::bad_usage) throw;
    }
  }
}

void NoisyFiles::take_facts(NoisyFrame& frame, const Sources& sources, int number) const {
  if (facts_) {
    frame.facts = *facts_;
  } else {
    FoundFacts found = facts_of(plan_, frame.gathered.input, sources);
    frame.facts = found.facts;
    std::ranges::move(found.notices, std::back_inserter(frame.gathered.notices));
  }
  frame.facts.frame = number;
}

void NoisyFiles::say_what_is_not_taken(NoisyFrame& frame) const {
  for (const Guide& g : guides_)
    if (!frame.gathered.asked_for.contains(g.layer) &&
        !(g.layer == layer_of({Aov::position, 0}) && asks_for_scene(plan_)))
      frame.gathered.notices.push_back(
          fmt::format("--guide {}={}: filter '{}' takes no such layer", g.layer, g.file, plan_.name));
}

NoisyFrame NoisyFiles::read(std::optional<int> number, bool backwards) const {
  const auto named = [&](const fs::path& p) { return number && is_pattern(p) ? file_of(p, *number) : p; };
  NoisyFrame frame{.in = named(options_.input), .out = named(options_.output)};
  require_other_file(frame.in, frame.out);
  frame.picture = read_exr(frame.in);
  Sources sources{&frame.picture, {}, options_.samples};
  sources.motion_scale = motion_scale_;
  sources.resting = options_.resting || !number;
  sources.backwards = backwards;
  for (const Guide& g : guides_) sources.separate.emplace(g.layer, read_exr(named(g.file)));
  frame.gathered = gather(plan_, sources, frame.in.string());
  say_what_is_not_taken(frame);
  take_facts(frame, sources, number ? *number : number_in(frame.picture));
  frame.plan = resolved(plan_, frame.facts);
  return frame;
}

void NoisyFiles::read_again(NoisyFrame& frame, const Region& before) const {
  frame.picture = read_exr(frame.in);
  if (frame.region() != before)
    throw InputError(frame.in.string(), "has another size than it had",
                     "files that stay as they are while they are filtered");
}

void NoisyFiles::write(const NoisyFrame& frame, const Image& rgb) const {
  write_exr(frame.out, delivered(frame.picture, rgb, frame.plan), options_.compression);
  write_png(fs::path(frame.out).replace_extension(".png"), rgb, static_cast<float>(options_.exposure));
}

}  // namespace tessera
