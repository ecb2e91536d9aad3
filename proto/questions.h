// SPDX-License-Identifier: Apache-2.0
// What people's commands (submit, jobs, watch, fetch, cancel, ...) and workers that need files ask of a
// coordinator, and what it answers, as values. A question that is not answered is asked again under the same
// number: asking twice does what asking once does.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "core/acceptance.h"
#include "core/error.h"
#include "core/sha256.h"
#include "core/submission.h"

namespace tessera {

inline constexpr std::size_t kPieceBytes = std::size_t{1} << 17;  // of a blob, in one message
inline constexpr std::uint64_t kMaxBlobBytes = std::uint64_t{1} << 40;
inline constexpr std::size_t kMaxListed =
    256;  // jobs, frames, events, workers in one answer; ask on for more

// --- Questions. ---

// Which of these blobs are not there, or not whole.
struct WhichLack {
  std::vector<Digest> blobs;  // at most kMaxListed
  bool operator==(const WhichLack&) const = default;
};
// `bytes` of the blob from `offset`. Pieces are taken in order, and what was taken stays taken when the
// connection goes. Answered by Agreed if all up to the end of the piece is there now, and with the last piece
// that the digest is right (or else Denied: then it is all forgotten); by Lacking, which says how much is,
// if what comes before the piece is missing.
struct PutPiece {
  Digest blob;
  std::uint64_t size = 0, offset = 0;  // of the whole blob; of this piece
  std::string bytes;                   // at most kPieceBytes
  bool operator==(const PutPiece&) const = default;
};
// Answered by a Piece of kPieceBytes, or fewer at the blob's end; at the very end by one without bytes.
struct GetPiece {
  Digest blob;
  std::uint64_t offset = 0;
  bool operator==(const GetPiece&) const = default;
};
// The job described by the blob `submission` (core/submission.h), which is there, and so is all it refers to.
struct Submit {
  JobName job;  // chosen by who submits
  Digest submission;
  bool operator==(const Submit&) const = default;
};
struct ListJobs {
  std::uint64_t after = 0;  // JobSummary::number
  bool operator==(const ListJobs&) const = default;
};
struct ShowJob {
  JobName job;
  std::uint32_t from = 0;  // place of the first frame listed
  bool previews = false;   // those of active frames are wanted
  // JobDetail::stamp of an earlier answer: this one waits until more has happened than that the work goes on,
  // at most a fraction of a second. 0: it is given at once.
  std::uint64_t seen = 0;
  bool operator==(const ShowJob&) const = default;
};
struct ListEvents {
  JobName job;
  std::uint64_t after = 0;  // JobEvent::number
  bool operator==(const ListEvents&) const = default;
};
// remove: of a job that is over; one that is not there (any more) is as good.
enum class Verb : std::uint8_t { cancel, pause, resume, set_priority, verify, remove };
struct Control {
  JobName job;
  Verb verb = Verb::cancel;
  int value = 0;  // set_priority: 0..100; verify: how many tasks are done again
  bool operator==(const Control&) const = default;
};
struct ListWorkers {
  std::string after;  // WorkerSummary::id
  bool operator==(const ListWorkers&) const = default;
};
struct ReleaseWorker {  // give one that was set aside another chance
  std::string worker;
  bool operator==(const ReleaseWorker&) const = default;
};
using Question = std::variant<WhichLack, PutPiece, GetPiece, Submit, ListJobs, ShowJob, ListEvents, Control,
                              ListWorkers, ReleaseWorker>;

// --- Answers. ---

struct Agreed {  // it is so (now)
  bool operator==(const Agreed&) const = default;
};
struct Lacking {
  struct Blob {
    Digest blob;
    std::uint64_t have = 0;  // bytes of it that are there already
    bool operator==(const Blob&) const = default;
  };
  std::vector<Blob> blobs;
  bool operator==(const Lacking&) const = default;
};
struct Piece {
  Digest blob;
  std::uint64_t size = 0, offset = 0;
  std::string bytes;
  bool operator==(const Piece&) const = default;
};

enum class JobState : std::uint8_t { queued, active, paused, completed, failed, cancelled };
// limited: it has an image, but a limit came before the one that was asked for.
enum class FrameState : std::uint8_t { waiting, active, completed, limited, failed };

struct JobSummary {
  std::uint64_t number = 0;  // in order of submission, from 1
  JobName job;
  std::string name, owner;  // owner: of the key it was submitted with
  JobState state = JobState::queued;
  std::string reason;  // why it failed, waits or was cancelled
  int priority = 50;
  std::uint32_t frames = 0, frames_done = 0, frames_failed = 0;
  std::int64_t submitted = 0;          // Unix time, ms
  double fraction = 0, seconds = 0;    // 0..1; since it began
  std::optional<double> seconds_left;  // expected
  std::uint64_t pixel_samples = 0, failed_tasks = 0;
  bool operator==(const JobSummary&) const = default;
};
struct FrameSummary {
  int frame = 0;  // its number
  FrameState state = FrameState::waiting;
  std::string reason;
  int round = 0;
  int tiles_done = 0, tiles = 0;  // of this round
  double fraction = 0, acceptable_share = 0, seconds = 0;
  std::optional<double> error, target;  // relMSE
  std::vector<float> errors;            // at each look so far
  int columns = 0;                      // of cells
  std::vector<CellStatus> cells;        // row-major; only of active frames
  // EXR and PNG; empty: not there (yet). Of an active frame the preview is what is known of it so far, made
  // anew every few seconds while somebody wants it; it can be fetched until the one after the next is there.
  Digest image, preview;
  bool operator==(const FrameSummary&) const = default;
};
struct JobDetail {
  JobSummary summary;
  std::uint32_t from = 0;
  std::vector<FrameSummary> frames;
  // Another one whenever a frame has ended, the job has come to another state or there is another preview; 0:
  // the job is over.
  std::uint64_t stamp = 0;
  bool operator==(const JobDetail&) const = default;
};
struct JobList {
  std::vector<JobSummary> jobs;
  bool operator==(const JobList&) const = default;
};
struct JobEvent {
  std::uint64_t number = 0;  // in the job, from 1
  std::int64_t when = 0;     // Unix time, ms
  std::string text;
  bool operator==(const JobEvent&) const = default;
};
struct EventList {
  std::vector<JobEvent> events;
  bool operator==(const EventList&) const = default;
};
struct WorkerSummary {
  std::string id, name, device_class;
  int slots = 0, held = 0;
  double tasks_per_second = 0;
  std::uint64_t done = 0, failed = 0;
  std::string set_aside;  // why; empty: it works
  bool operator==(const WorkerSummary&) const = default;
};
struct WorkerList {
  std::vector<WorkerSummary> workers;
  bool operator==(const WorkerList&) const = default;
};
struct Denied {
  ExitCode code = ExitCode::bad_usage;
  std::string reason;
  bool operator==(const Denied&) const = default;
};
using Reply = std::variant<Agreed, Lacking, Piece, JobList, JobDetail, EventList, WorkerList, Denied>;

// As they travel.
struct Ask {
  std::uint64_t number = 0;  // of the asker's
  Question question;
};
struct Answer {
  std::uint64_t number = 0;  // of the question
  Reply reply;
};

}  // namespace tessera
