// SPDX-License-Identifier: Apache-2.0
// Failures that a user meets: which exit code they end in, and the one exception that carries them.
// A bug is an assert; an expected answer is an optional or a variant; everything else is an Error, caught at
// the edge of a task or in main.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace tessera {

// Documented in docs/USAGE.md and stable.
enum class ExitCode {
  done = 0,
  internal_error = 1,
  bad_usage = 2,
  bad_input = 3,  // scene or input file: a retry is useless
  out_of_memory = 4,
  no_device = 5,
  unreachable = 6,
  job_failed = 7,
  stopped_at_limit = 8,  // not acceptable yet; the image was written
  interrupted = 130,
};

class Error : public std::runtime_error {
 public:
  Error(ExitCode code, const std::string& what) : std::runtime_error(what), code_(code) {}
  ExitCode code() const { return code_; }

 private:
  ExitCode code_;
};

// Bad input: where it is (file, file:line or file:/json/pointer), what is wrong, and what is accepted.
class InputError : public Error {
 public:
  InputError(std::string_view where, std::string_view what, std::string_view accepted = {})
      : Error(ExitCode::bad_input, text(where, what, accepted)) {}

 private:
  static std::string text(std::string_view where, std::string_view what, std::string_view accepted) {
    std::string t = std::string(where) + ": " + std::string(what);
    if (!accepted.empty()) t += "; accepted: " + std::string(accepted);
    return t;
  }
};

}  // namespace tessera
