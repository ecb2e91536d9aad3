// SPDX-License-Identifier: Apache-2.0
// Jobs, frames and workers of a farm as lines for people and as JSON for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include <string>
#include <string_view>

#include "core/error.h"
#include "proto/questions.h"

namespace tessera {

std::string_view to_string(JobState);
std::string_view to_string(FrameState);

std::string line_of(const JobSummary&);  // without a newline
std::string line_of(const FrameSummary&);
std::string line_of(const WorkerSummary&);
std::string line_of(const JobEvent&);

nlohmann::json json_of(const JobSummary&);
nlohmann::json json_of(const FrameSummary&);
nlohmann::json json_of(const WorkerSummary&);
nlohmann::json json_of(const JobEvent&);

// "3 s", "12 min", "2 h 5 min".
std::string duration_words(double seconds);
// ISO 8601, UTC, of Unix milliseconds.
std::string time_words(std::int64_t ms);

bool is_over(const JobSummary&);
// What a command that waited for the job ends with. `limited`: a frame stopped at a limit.
ExitCode exit_code(const JobSummary&, bool limited);

}  // namespace tessera
