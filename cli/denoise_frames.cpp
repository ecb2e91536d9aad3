// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise_frames.h"

#include <fmt/format.h>

#include "cli/picture_options.h"
#include "core/error.h"
#include "core/sequence.h"

namespace tessera {
namespace {

// Those of the sequence that are there and at most `reach` frames before one of `wanted`, or behind it.
std::set<int> with_handles(const std::set<int>& wanted, const std::vector<int>& there, int reach,
                           bool before) {
  std::set<int> all = wanted;
  for (const int f : there) {
    const auto next = wanted.lower_bound(f);
    if (before ? next != wanted.end() && *next - f <= reach
               : next != wanted.begin() && f - *std::prev(next) <= reach)
      all.insert(f);
  }
  return all;
}

std::set<int> wanted_frames(const DenoiseOptions& o, const std::vector<int>& there) {
  const std::vector<int> frames = o.frames ? parse_frames(*o.frames) : there;
  if (frames.empty())
    throw InputError(o.input, "no file of that pattern is there", "a sequence of EXR files");
  return {frames.begin(), frames.end()};
}

}  // namespace

void check_options(const DenoiseOptions& o, const FilterPlan& plan) {
  const bool sequence = is_pattern(o.input);
  if (std::filesystem::path(o.output).extension() != ".exr")
    refuse_option("--output", o.output, "a name that ends in .exr; the PNG goes beside it");
  if (!sequence && is_pattern(o.output))
    refuse_option("--output", o.output, "a name without #### and %04d, as the input is a single image");
  constexpr std::string_view kSequence = "only with an input that has #### or %04d in its name";
  if (!sequence && o.frames) refuse_option("--frames", *o.frames, kSequence);
  if (sequence && !is_pattern(o.output))
    refuse_option("--output", o.output, "a name with #### or %04d, as the input is a sequence");
  if (o.handles == 0 && !o.both_ways && o.cuts.empty()) return;
  const std::string_view option = o.both_ways ? "--both-ways" : !o.cuts.empty() ? "--cuts" : "--handles";
  const std::string value = o.both_ways ? "on" : !o.cuts.empty() ? o.cuts : std::to_string(o.handles);
  if (!sequence) refuse_option(option, value, kSequence);
  if (plan.history() == 0)
    refuse_option(option, value,
                  fmt::format("only with a filter that has history=on, which {} has not", plan.name));
}

std::set<int> cuts_of(const DenoiseOptions& o) {
  if (o.cuts.empty()) return {};
  const std::vector<int> cuts = parse_frames(o.cuts);
  return {cuts.begin(), cuts.end()};
}

DenoiseFrames frames_of(const DenoiseOptions& o) {
  const std::vector<int> there = frames_there(o.input);
  DenoiseFrames frames{.wanted = wanted_frames(o, there)};
  frames.forwards = with_handles(frames.wanted, there, o.handles, true);
  if (o.both_ways) frames.backwards = with_handles(frames.wanted, there, o.handles, false);
  return frames;
}

}  // namespace tessera
