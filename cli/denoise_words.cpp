// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise_words.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <ostream>

#include "core/layers.h"

namespace tessera {
namespace {

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

}  // namespace

void DenoiseWords::say(const std::string& notice) {
  if (said_.insert(notice).second) problems_ << "tessera: " << notice << '\n';
}

void DenoiseWords::failed(int number, const std::string& why) {
  problems_ << "tessera: frame " << number << ": " << why << '\n';
}

void DenoiseWords::starts_anew(int number, bool backwards, const std::string& why) {
  problems_ << fmt::format("tessera: frame {} starts anew{}: {}\n", number, backwards ? ", backwards" : "",
                           why);
}

void DenoiseWords::complain(const NoisyFrame& frame, const std::vector<std::string>& problems) {
  for (const std::string& p : problems) problems_ << "tessera: " << frame.in.string() << ": " << p << '\n';
}

void DenoiseWords::notices(const NoisyFrame& frame, bool written) {
  for (const std::string& notice : frame.gathered.notices) say(notice);
  complain(frame, frame.gathered.defects);
  if (written) complain(frame, broken(frame.plan, frame.gathered.input));
}

void DenoiseWords::handed_in(const JobName& job, std::size_t frames, bool backwards) {
  if (quiet_) return;
  out_ << fmt::format("job {}: {} frame{} to filter{}\n", job, frames, frames == 1 ? "" : "s",
                      backwards ? " backwards" : "");
  out_.flush();  // it may be asked for while this one waits
}

void DenoiseWords::done(const NoisyFrame& frame, Size tile, const std::string& where, double seconds) {
  if (quiet_) return;
  out_ << fmt::format("{}: {} in tiles of {}x{}{}, {:.2f} s\n", frame.out.string(), to_string(frame.plan),
                      tile.width, tile.height, where, seconds);
}

}  // namespace tessera
