// SPDX-License-Identifier: Apache-2.0
#include "proto/submission_codec.h"

#include <fmt/format.h>

#include "core/sequence.h"
#include "proto/codec.h"
#include "proto/submission.pb.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxHeadBytes = 1 << 16;
constexpr int kMaxNames = 1 << 20;

void to_wire(const std::vector<std::string>& names, wire::Names& w) {
  for (const std::string& name : names) {
    w.add_lengths(static_cast<std::uint32_t>(name.size()));
    *w.mutable_text() += name;
  }
}

void to_wire(const JobLimits& limits, wire::JobLimits& w) {
  if (limits.seconds) w.set_seconds(*limits.seconds);
  if (limits.pixel_samples) w.set_pixel_samples(*limits.pixel_samples);
  if (limits.bytes) w.set_bytes(*limits.bytes);
}

wire::SubmissionHead head_of(const Submission& s) {
  wire::SubmissionHead head;
  head.set_name(s.name);
  head.set_priority(s.priority);
  for (const JobName& job : s.after) head.add_after(job);
  to_wire(s.limits, *head.mutable_limits());
  to_wire(s.job, *head.mutable_job());
  head.mutable_facts()->set_diameter(s.facts.diameter);
  head.mutable_facts()->set_light(s.facts.light);
  head.mutable_facts()->set_frame(s.facts.frame);
  head.set_transparent(s.transparent);
  head.set_compression(s.compression);
  head.set_exposure(s.exposure);
  head.set_layers_for(s.layers_for);
  return head;
}

std::vector<std::string> names_from(const wire::Names& w, std::string_view field) {
  require(w.lengths_size() <= kMaxNames, field, "too many entries");
  std::uint64_t bytes = 0;
  for (const std::uint32_t length : w.lengths()) {
    require(length <= kMaxName, field, "a name is too long");
    bytes += length;
  }
  require(bytes == w.text().size(), field, "the lengths are not those of the names");
  std::vector<std::string> names;
  names.reserve(w.lengths_size());
  std::size_t at = 0;
  for (const std::uint32_t length : w.lengths()) {
    names.push_back(w.text().substr(at, length));
    at += length;
  }
  return names;
}

void to_wire(const Region& r, google::protobuf::RepeatedField<std::int32_t>& w) {
  for (const int at : {r.x0, r.y0, r.x1, r.y1}) w.Add(at);
}

void to_wire(const std::vector<SubmittedFrame>& frames, wire::GivenFrames& w) {
  for (const SubmittedFrame& f : frames) {
    *w.mutable_planes() += f.given.planes;
    to_wire(f.region, *w.mutable_regions());
    to_wire(f.given.display, *w.mutable_regions());
    w.add_goes_on(f.given.goes_on);
    w.add_facts(f.diameter);
    w.add_facts(f.light);
  }
}

std::vector<SubmittedFrame> given_from(const wire::GivenFrames& w) {
  constexpr std::size_t kDigest = 64, kNumbers = 8, kFacts = 2;
  const auto count = static_cast<std::size_t>(w.goes_on_size());
  require(count <= kMaxFrames, "given", "too many entries");
  require(w.planes().size() == kDigest * count &&
              static_cast<std::size_t>(w.regions_size()) == kNumbers * count &&
              static_cast<std::size_t>(w.facts_size()) == kFacts * count,
          "given", "its lists are not of the same frames");
  std::vector<SubmittedFrame> frames(count);
  for (std::size_t i = 0; i < count; ++i) {
    const auto region = [&](std::size_t first) {
      const std::int32_t* n = w.regions().data() + kNumbers * i + first;
      return Region{n[0], n[1], n[2], n[3]};
    };
    frames[i] = {
        .given = {w.planes().substr(kDigest * i, kDigest), region(4), w.goes_on(static_cast<int>(i))},
        .region = region(0),
        .diameter = w.facts(static_cast<int>(kFacts * i)),
        .light = w.facts(static_cast<int>(kFacts * i + 1))};
  }
  return frames;
}

JobLimits limits_from(const wire::JobLimits& w) {
  JobLimits limits;
  if (w.has_seconds()) limits.seconds = w.seconds();
  if (w.has_pixel_samples()) limits.pixel_samples = w.pixel_samples();
  if (w.has_bytes()) limits.bytes = w.bytes();
  return limits;
}

void read_head(const std::string& bytes, Submission& s) {
  require(bytes.size() <= kMaxHeadBytes, "head", "too long");
  wire::SubmissionHead w;
  require(w.ParseFromString(bytes), "head", "is not that of a submission");
  s.name = text_from(w.name(), kMaxName, "name");
  s.priority = w.priority();
  s.after = {w.after().begin(), w.after().end()};
  s.limits = limits_from(w.limits());
  s.job = job_from(w.job());
  s.facts = {w.facts().diameter(), w.facts().light(), w.facts().frame()};
  s.transparent = w.transparent();
  s.compression = text_from(w.compression(), kMaxName, "compression");
  s.exposure = w.exposure();
  s.layers_for = text_from(w.layers_for(), kMaxName, "layers_for");
}

}  // namespace

std::string encode(const Submission& s) {
  wire::Submission w;
  head_of(s).SerializeToString(w.mutable_head());
  w.mutable_frames()->Add(s.frames.begin(), s.frames.end());
  w.mutable_cuts()->Add(s.cuts.begin(), s.cuts.end());
  to_wire(s.names.light_groups, *w.mutable_light_groups());
  to_wire(s.names.objects, *w.mutable_objects());
  to_wire(s.names.materials, *w.mutable_materials());
  if (!s.given.empty()) to_wire(s.given, *w.mutable_given());
  std::string bytes;
  w.SerializeToString(&bytes);
  if (bytes.size() > kMaxSubmissionBytes)
    throw Error(ExitCode::bad_usage,
                fmt::format("the names of the scene's objects and materials, or its frames, take {} MiB; "
                            "accepted: at most {} MiB for all of a job",
                            bytes.size() >> 20, kMaxSubmissionBytes >> 20));
  return bytes;
}

Submission decode_submission(std::string_view bytes) {
  require(bytes.size() <= kMaxSubmissionBytes, "submission", "too long");
  wire::Submission w;
  require(w.ParseFromArray(bytes.data(), static_cast<int>(bytes.size())), "submission", "is none");
  require(w.frames_size() <= kMaxFrames, "frames", "too many entries");
  require(w.cuts_size() <= kMaxFrames, "cuts", "too many entries");
  Submission s;
  read_head(w.head(), s);
  s.frames = {w.frames().begin(), w.frames().end()};
  s.cuts = {w.cuts().begin(), w.cuts().end()};
  s.names = {names_from(w.light_groups(), "light_groups"), names_from(w.objects(), "objects"),
             names_from(w.materials(), "materials")};
  if (w.has_given()) s.given = given_from(w.given());
  try {
    validate(s);
  } catch (const Error& error) {
    throw ProtocolError("submission", error.what());
  }
  return s;
}

}  // namespace tessera
