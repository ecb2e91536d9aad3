// SPDX-License-Identifier: Apache-2.0
// What is handed in to a farm: frames of one scene, or frames that are there and are only to be filtered, and
// everything about them that is not in the scene's files, or with their planes. Complete: nothing else is
// asked of who submitted it, nor of the scene, until its images are there.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/filter/filter.h"
#include "core/job.h"

namespace tessera {

// A job, as people call it: 1 to 64 letters, digits, '-', '_' and '.', not beginning with '.'.
using JobName = std::string;
bool is_job_name(std::string_view);

inline constexpr int kHighestPriority = 100;

// What a job may use before it is ended, with the images it has by then; none: no limit.
struct JobLimits {
  std::optional<double> seconds;               // from the begin of its first frame
  std::optional<std::uint64_t> pixel_samples;  // over all frames
  std::optional<std::uint64_t> bytes;          // of memory that its frames take in the coordinator
  bool operator==(const JobLimits&) const = default;
};

// What layers and metadata of the images speak of.
struct SceneNames {
  std::vector<std::string> light_groups, objects, materials;
  bool operator==(const SceneNames&) const = default;
};

// A frame that is not rendered, but comes as the planes that its filter takes.
struct SubmittedFrame {
  Given given;
  Region region;                   // that they cover
  double diameter = 0, light = 0;  // facts of what it shows
  bool operator==(const SubmittedFrame&) const = default;
};

struct Submission {
  std::string name;            // for people: any text of 1 to 256 bytes
  int priority = 50;           // 0..100; the higher, the sooner
  std::vector<JobName> after;  // jobs that must be completed before
  JobLimits limits;
  Job job;                  // of every frame, but for its number; filters that go by facts not resolved
  std::vector<int> frames;  // their numbers, in the order in which they are wanted; each once
  std::vector<int> cuts;    // numbers of frames that start anew; rising
  std::vector<SubmittedFrame> given;  // of each frame; none: they are rendered
  SceneFacts facts;                   // of the scene
  SceneNames names;
  bool transparent = false;  // the scene stands before nothing: previews have coverage
  std::string compression = "zip";
  double exposure = 0;     // of the previews, stops
  std::string layers_for;  // a filter: all that it takes is written, to all of its bits; empty: none

  bool operator==(const Submission&) const = default;
};

// Throws InputError that names the field, unless every number is in its range.
void validate(const Submission&);

// The job of a frame by its place in the list, with its number, and its filter resolved.
Job job_of(const Submission&, std::size_t place);
std::vector<Job> jobs_of(const Submission&);  // of all

}  // namespace tessera
