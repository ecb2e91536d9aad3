// SPDX-License-Identifier: Apache-2.0
// What people may have the farm do with its jobs, and how they are described to them.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "coordinator/farm/farm.h"
#include "core/bundle.h"
#include "proto/clock.h"
#include "proto/submission_codec.h"

namespace tessera {
namespace {

constexpr std::size_t kMaxBundleText = std::size_t{1} << 26;

std::vector<FrameRecord> waiting_frames(const Submission& s) {
  std::vector<FrameRecord> frames;
  for (std::size_t i = 0; i < s.frames.size(); ++i)
    frames.push_back({.place = static_cast<std::uint32_t>(i), .frame = s.frames[i]});
  return frames;
}

// What the job needs besides its submission: the planes of frames that are given, or its scene. Throws if
// some of it is not there.
std::vector<Digest> blobs_of(BlobStore& blobs, const Submission& s) {
  std::vector<Digest> needed;
  for (const SubmittedFrame& frame : s.given) needed.push_back(frame.given.planes);
  if (s.given.empty()) {
    const Digest& bundle = needed.emplace_back(s.job.scene.bundle);
    if (bundle.empty()) throw InputError("job: scene.bundle", "is missing", "a job whose scene was uploaded");
    if (blobs.has(bundle))
      for (const auto& file : parse_bundle(blobs.read(bundle)).files) needed.push_back(file.digest);
  }
  for (const Digest& blob : needed)
    if (!blobs.has(blob))
      throw InputError("blob " + blob, "is not here", "what is uploaded before it is needed");
  return needed;
}

FrameSummary summary_of(const FrameRecord& record, const Submission& s) {
  return {.frame = record.frame,
          .state = record.state,
          .reason = record.reason,
          .round = record.rounds,
          .fraction = record.state == FrameState::waiting ? 0.0 : 1.0,
          .acceptable_share = record.acceptable_share,
          .seconds = record.seconds,
          .error = record.error,
          .target = s.job.acceptance.relmse,
          .errors = record.errors,
          .image = record.image,
          .preview = record.preview};
}

void add_progress(FrameSummary& f, const Coordinator::FrameNow& now) {
  const Frame& frame = *now.state->frame;
  const Progress p = frame.progress(now.seconds);
  f.state = FrameState::active;
  f.round = p.round;
  f.tiles_done = p.tiles_done;
  f.tiles = p.tiles_round;
  f.fraction = p.fraction;
  f.acceptable_share = p.acceptable_share;
  f.seconds = now.seconds;
  f.error = p.error;
  f.errors = now.state->errors;
  if (!frame.cell_states().empty()) f.columns = frame.columns();
  for (const CellState& cell : frame.cell_states()) f.cells.push_back(cell.status);
}

}  // namespace

void Farm::submit(const JobName& name, const Digest& digest, const std::string& owner, int highest) {
  if (!trouble_.empty()) throw StoreFull(store_.folder(), trouble_);
  const Submission s = decode_submission(store_.blobs().read(digest));
  const std::vector<Digest> needed = blobs_of(store_.blobs(), s);
  for (const JobName& before : s.after)
    if (!queue_.find(before) && !store_.job(before))
      throw InputError("job: after", "there is no job " + before, "jobs that were submitted before");
  const double bytes = bytes_of(s);
  const double most = std::min(options_.memory, static_cast<double>(s.limits.bytes.value_or(UINT64_MAX)));
  if (bytes > most)
    throw Error(
        ExitCode::out_of_memory,
        fmt::format(
            "job: its frames take {:.0f} MiB here, more than the limit of {:.0f} MiB; a crop, a smaller"
            " size or fewer layers take less",
            bytes / (1 << 20), most / (1 << 20)));
  const JobRecord record{.job = name,
                         .submission = digest,
                         .name = s.name,
                         .owner = owner,
                         .submitted = unix_ms(),
                         .priority = std::min(s.priority, highest)};
  const Store::Added added = store_.add(record, waiting_frames(s), needed);
  if (!added.fresh) return;
  open(added.job);
  note(open_.at(name), fmt::format("submitted by {}: {} frames", owner, s.frames.size()));
  changed_ = true;
}

OpenJob& Farm::open_job(const JobName& name) {
  const auto found = open_.find(name);
  if (found != open_.end()) return found->second;
  throw Error(ExitCode::bad_usage, fmt::format("job {} is over", record(name).job));
}

void Farm::cancel(const JobName& name, const std::string& by) {
  OpenJob& job = open_job(name);
  const std::uint64_t number = job.record.number;
  const std::size_t frames = job.submission.frames.size();
  end(job, JobState::cancelled, "cancelled by " + by);
  for (std::size_t i = 0; i < frames; ++i) store_.drop_journal(number, static_cast<std::uint32_t>(i));
}

void Farm::pause(const JobName& name) {
  OpenJob& job = open_job(name);
  queue_.pause(name);
  if (job.shot && job.record.state == JobState::active) coordinator_.pause(*job.shot);
  job.record.state = JobState::paused;
  save(job);
  note(job, "paused");
}

void Farm::resume(const JobName& name) {
  OpenJob& job = open_job(name);
  if (job.record.state != JobState::paused) return;
  queue_.resume(name);
  job.record.state = queue_.find(name)->state;
  if (job.shot && trouble_.empty()) coordinator_.resume(*job.shot);
  save(job);
  note(job, "goes on");
  changed_ = true;
}

void Farm::set_priority(const JobName& name, int priority) {
  OpenJob& job = open_job(name);
  queue_.set_priority(name, priority);
  job.record.priority = priority;
  if (job.shot && !coordinator_.over(*job.shot)) coordinator_.set_standing(*job.shot, standing_of(job));
  save(job);
  note(job, fmt::format("has priority {}", priority));
  changed_ = true;
}

void Farm::remove(const JobName& name) {
  if (open_.contains(name))
    throw Error(ExitCode::bad_usage, fmt::format("job {} is not over; accepted: one that is", name));
  if (const auto other = comes_before(name))
    throw Error(ExitCode::bad_usage, fmt::format("job {} comes after job {}", *other, name));
  const std::uint64_t number = record(name).number;
  store_.remove(number);
  spdlog::info("job {}: removed", number);
}

JobRecord Farm::record(const JobName& name) {
  if (const auto found = open_.find(name); found != open_.end()) return found->second.record;
  if (const auto stored = store_.job(name)) return *stored;
  throw InputError("job " + name, "is not known here", "what tessera jobs lists");
}

std::uint64_t Farm::stamp(const JobName& name) const {
  const auto found = open_.find(name);
  return found == open_.end() ? 0 : found->second.stamp;
}

JobSummary Farm::summary(const JobRecord& r) {
  JobSummary s{.number = r.number,
               .job = r.job,
               .name = r.name,
               .owner = r.owner,
               .state = r.state,
               .reason = r.reason,
               .priority = r.priority,
               .submitted = r.submitted,
               .fraction = r.state == JobState::completed ? 1.0 : 0.0,
               .seconds = r.seconds,
               .pixel_samples = r.pixel_samples,
               .failed_tasks = r.failed_tasks};
  const Store::FrameCounts counts = store_.count_frames(r.number);
  s.frames = counts.all;
  s.frames_done = counts.done;
  s.frames_failed = counts.failed;
  if (s.frames > 0) s.fraction = static_cast<double>(s.frames_done + s.frames_failed) / s.frames;
  const auto found = open_.find(r.job);
  if (found == open_.end()) return s;
  const OpenJob& job = found->second;
  if (s.reason.empty()) s.reason = queue_.waits_for(r.job);
  s.seconds = seconds_of(job);
  if (!job.shot) return s;
  double under_way = static_cast<double>(job.writing);
  for (const auto& [i, frame] : coordinator_.frames(*job.shot)) {  // none, if it is over
    const Progress p = frame.state->frame->progress(frame.seconds);
    under_way += p.fraction;
    s.pixel_samples += static_cast<std::uint64_t>(p.samples_done);
  }
  s.fraction = std::min(0.999, s.fraction + under_way / s.frames);
  if (s.fraction > 0) s.seconds_left = s.seconds * (1 - s.fraction) / s.fraction;
  return s;
}

std::vector<FrameSummary> Farm::frames(const JobRecord& r, std::uint32_t from, std::size_t most,
                                       bool previews) {
  const Submission s = submission_of(r);
  std::map<std::size_t, Coordinator::FrameNow> now;  // by place
  if (const auto found = open_.find(r.job); found != open_.end() && found->second.shot)
    for (const auto& [i, frame] : coordinator_.frames(*found->second.shot))
      now[found->second.places[i]] = frame;
  std::vector<FrameSummary> all;
  for (const FrameRecord& frame : store_.frames(r.number, from, most)) {
    all.push_back(summary_of(frame, s));
    const auto active = now.find(frame.place);
    if (active == now.end()) continue;
    add_progress(all.back(), active->second);
    const Previews::Key which{r.job, frame.place};
    if (previews) previews_.asked(which, clock_now());
    all.back().preview = previews_.last(which);
  }
  return all;
}

Submission Farm::submission_of(const JobRecord& record) {
  if (const auto found = open_.find(record.job); found != open_.end()) return found->second.submission;
  return decode_submission(store_.blobs().read(record.submission));
}

}  // namespace tessera
