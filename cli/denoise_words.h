// SPDX-License-Identifier: Apache-2.0
// What `tessera denoise` says, wherever it filters.
#pragma once

#include <iosfwd>
#include <set>
#include <string>
#include <vector>

#include "cli/noisy_files.h"
#include "core/submission.h"

namespace tessera {

class DenoiseWords {
 public:
  // `out`: what was done; `problems`: what is to be known of it. Both are borrowed.
  DenoiseWords(std::ostream& out, std::ostream& problems, bool quiet)
      : out_(out), problems_(problems), quiet_(quiet) {}

  // The same for all frames: once is enough.
  void say(const std::string& notice);
  void failed(int number, const std::string& why);
  void starts_anew(int number, bool backwards, const std::string& why);
  // What was not there or is broken in what the frame was gathered from; of pixels only if it is written.
  void notices(const NoisyFrame&, bool written);
  void handed_in(const JobName& job, std::size_t frames, bool backwards);
  // It is written. `where`: " on a farm", or nothing.
  void done(const NoisyFrame&, Size tile, const std::string& where, double seconds);

 private:
  void complain(const NoisyFrame&, const std::vector<std::string>& problems);

  std::ostream &out_, &problems_;
  bool quiet_;
  std::set<std::string> said_;
};

}  // namespace tessera
