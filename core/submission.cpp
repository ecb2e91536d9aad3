// SPDX-License-Identifier: Apache-2.0
#include "core/submission.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <unordered_set>

#include "core/error.h"
#include "core/exr.h"
#include "core/sequence.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxAfter = 64, kMaxNames = 1 << 20;
constexpr double kMaxStops = 64;

void require(bool good, std::string_view field, std::string_view accepted) {
  if (!good) throw InputError(fmt::format("job: {}", field), "cannot be so", accepted);
}

void require_names(const std::vector<std::string>& names, std::string_view field) {
  require(names.size() <= kMaxNames &&
              std::ranges::all_of(names, [](const auto& n) { return n.size() <= kMaxName; }),
          field, "at most 1048576 names of 256 bytes");
}

void require_limits(const JobLimits& limits) {
  require(!limits.seconds || (std::isfinite(*limits.seconds) && *limits.seconds > 0), "limits.seconds",
          "above 0");
  require(!limits.pixel_samples || *limits.pixel_samples > 0, "limits.pixel_samples", "above 0");
  require(!limits.bytes || *limits.bytes > 0, "limits.bytes", "above 0");
}

void require_given(const Submission& s) {
  require(!s.job.given, "given", "none in the job of all frames");
  if (s.given.empty()) return;
  require(s.given.size() == s.frames.size(), "given", "as many as there are frames, or none");
  require(s.layers_for.empty(), "layers_for", "none of frames that are given");
  for (std::size_t i = 0; i < s.given.size(); ++i) {
    const SubmittedFrame& g = s.given[i];
    require(std::isfinite(g.diameter) && g.diameter >= 0, "given.diameter", "0 or more");
    require(std::isfinite(g.light) && g.light >= 0, "given.light", "0 or more");
    validate(job_of(s, i));
  }
}

}  // namespace

bool is_job_name(std::string_view name) {
  const auto fits = [](char c) {
    return ('0' <= c && c <= '9') || ('a' <= c && c <= 'z') || ('A' <= c && c <= 'Z') || c == '-' ||
           c == '_' || c == '.';
  };
  return !name.empty() && name.size() <= 64 && name.front() != '.' && std::ranges::all_of(name, fits);
}

void validate(const Submission& s) {
  require(!s.name.empty() && s.name.size() <= kMaxName, "name", "1 to 256 bytes");
  require(0 <= s.priority && s.priority <= kHighestPriority, "priority", "0 to 100");
  require(s.after.size() <= kMaxAfter && std::ranges::all_of(s.after, is_job_name), "after",
          "at most 64 jobs");
  require_limits(s.limits);
  require(!s.frames.empty() && s.frames.size() <= kMaxFrames, "frames", fmt::format("1 to {}", kMaxFrames));
  require(std::unordered_set<int>(s.frames.begin(), s.frames.end()).size() == s.frames.size(), "frames",
          "each once");
  require(
      s.cuts.size() <= kMaxFrames && std::ranges::adjacent_find(s.cuts, std::greater_equal()) == s.cuts.end(),
      "cuts", "rising numbers, no more than a job may have frames");
  require(std::isfinite(s.facts.diameter) && s.facts.diameter >= 0, "facts.diameter", "0 or more");
  require(std::isfinite(s.facts.light) && s.facts.light >= 0, "facts.light", "0 or more");
  require_names(s.names.light_groups, "names.light_groups");
  require_names(s.names.objects, "names.objects");
  require_names(s.names.materials, "names.materials");
  require(std::ranges::find(exr_compressions(), s.compression) != exr_compressions().end(), "compression",
          fmt::format("{}", fmt::join(exr_compressions(), " ")));
  require(std::isfinite(s.exposure) && std::abs(s.exposure) <= kMaxStops, "exposure", "-64 to 64");
  require(s.layers_for.size() <= kMaxName, "layers_for", "at most 256 bytes");
  if (!s.layers_for.empty()) parse_filter(s.layers_for);
  validate(s.job);
  require_given(s);
}

Job job_of(const Submission& s, std::size_t place) {
  Job job = s.job;
  SceneFacts facts = s.facts;
  if (!s.given.empty()) {
    const SubmittedFrame& g = s.given[place];
    job.given = g.given;
    job.crop = g.region;
    facts.diameter = g.diameter;
    facts.light = g.light;
  }
  job.frame = facts.frame = s.frames[place];
  job.cut = std::ranges::binary_search(s.cuts, job.frame);
  job.filter = resolved(s.job.filter, facts);
  return job;
}

std::vector<Job> jobs_of(const Submission& s) {
  std::vector<Job> jobs;
  jobs.reserve(s.frames.size());
  for (std::size_t i = 0; i < s.frames.size(); ++i) jobs.push_back(job_of(s, i));
  return jobs;
}

}  // namespace tessera
