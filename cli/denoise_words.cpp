// SPDX-License-Identifier: Apache-2.0
#include "cli/denoise_words.h"

#include <fmt/format.h>

#include <ostream>

namespace tessera {

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
  if (written) complain(frame, frame.gathered.broken);
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
