// SPDX-License-Identifier: Apache-2.0
// One question and one answer of every kind, and a job as it is handed in, with no field at its default.
#pragma once

#include <string>
#include <vector>

#include "core/sha256.h"
#include "proto/questions.h"

namespace tessera {

inline std::vector<Question> sample_questions() {
  const Digest a = sha256("a"), b = sha256("b");
  return {WhichLack{{a, b}},
          PutPiece{a, 1ull << 35, 1ull << 34, std::string("pie\0ce", 6)},
          GetPiece{b, 1ull << 33},
          Submit{"shot.12-b", a},
          ListJobs{7},
          ShowJob{"shot.12-b", 256, true, 77},
          ListEvents{"shot.12-b", 1ull << 40},
          Control{"shot.12-b", Verb::set_priority, 99},
          Control{"shot.12-b", Verb::verify, 12},
          Control{"shot.12-b", Verb::resume, 0},
          ListWorkers{"host-1.7f3a"},
          ReleaseWorker{"host-1.7f3a"}};
}

inline JobSummary sample_summary() {
  return {.number = 12,
          .job = "shot.12-b",
          .name = "caf\xc3\xa9 \xff",
          .owner = "ann",
          .state = JobState::failed,
          .reason = "a worker's device is gone",
          .priority = 70,
          .frames = 100,
          .frames_done = 40,
          .frames_failed = 60,
          .submitted = 1'700'000'000'123,
          .fraction = 0.75,
          .seconds = 12.5,
          .seconds_left = 3.25,
          .pixel_samples = 1ull << 50,
          .failed_tasks = 9};
}

inline FrameSummary sample_frame() {
  return {.frame = -3,
          .state = FrameState::active,
          .reason = "waits for frame 2",
          .round = 4,
          .tiles_done = 3,
          .tiles = 8,
          .fraction = 0.5,
          .acceptable_share = 0.25,
          .seconds = 1.5,
          .error = 0.001,
          .target = 0.0025,
          .errors = {0.25f, -0.125f, 0.001f},
          .columns = 2,
          .cells = {CellStatus::open, CellStatus::accepted, CellStatus::exhausted, CellStatus::open},
          .image = sha256("image"),
          .preview = sha256("preview")};
}

inline WorkerSummary sample_worker() {
  return {.id = "host-1.7f3a",
          .name = "host-1",
          .device_class = "avx512 pocl-3.1",
          .slots = 12,
          .held = 24,
          .tasks_per_second = 3.5,
          .done = 1000,
          .failed = 3,
          .set_aside = "failed 3 tasks of 3 jobs"};
}

inline std::vector<Reply> sample_replies() {
  const Digest a = sha256("a"), b = sha256("b");
  return {Agreed{},
          Lacking{{{a, 1ull << 34}, {b, 0}}},
          Piece{a, 1ull << 35, 1ull << 34, std::string("pie\0ce", 6)},
          JobList{{sample_summary(), sample_summary()}},
          JobDetail{sample_summary(), 256, {sample_frame(), sample_frame()}, 77},
          EventList{{{5, 1'700'000'000'123, "frame 3 is there"}}},
          WorkerList{{sample_worker()}},
          Denied{ExitCode::job_failed, "there is no such job"}};
}

inline Submission sample_submission() {
  Submission s;
  s.name = "Atrium, caf\xc3\xa9 \xff";
  s.priority = 99;
  s.after = {"first", "second.1"};
  s.limits = {.seconds = 3600.5, .pixel_samples = 1ull << 40, .bytes = 1ull << 33};
  s.job.scene = {"shots/atrium.json", sha256("scene"), sha256("bundle")};
  s.job.render.size = {640, 360};
  s.job.render.camera = "left";
  s.job.acceptance = {.relmse = 0.0025, .first_samples = 32, .max_samples = 1024, .max_seconds = 12.5};
  s.frames = {3, -1, 999'999};
  s.facts = {.diameter = 12.5, .light = 0.75, .frame = 4};
  s.names = {{"key", "fill"}, {"lamp", "", "chair"}, {"oak"}};
  s.transparent = true;
  s.compression = "piz";
  s.exposure = -1.5;
  s.layers_for = "svgf";
  return s;
}

}  // namespace tessera
