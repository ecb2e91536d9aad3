// SPDX-License-Identifier: Apache-2.0
#include "proto/wire_summaries.h"

#include <algorithm>
#include <cmath>

#include "proto/codec.h"
#include "proto/wire_questions.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

void put_cells(const FrameSummary& s, wire::FrameSummary& w, std::size_t& room) {
  if (s.cells.size() > room) return;
  room -= s.cells.size();
  w.set_columns(s.columns);
  w.set_cells(s.cells.data(), s.cells.size());
}

double share_from(double value, std::string_view field) {
  require(value >= 0 && value <= 1, field, "not from 0 to 1");
  return value;
}

void require_cells(const wire::FrameSummary& w) {
  const int columns = whole_from(w.columns(), 0, kMaxColumns, "columns");
  require(columns == 0 ? w.cells().empty() : !w.cells().empty() && w.cells().size() % columns == 0, "cells",
          "are not whole rows");
  const auto is_cell = [](char c) { return c >= 0 && c <= static_cast<char>(CellStatus::exhausted); };
  require(std::ranges::all_of(w.cells(), is_cell), "cells", "no such status");
}

Digest digest_or_none(const std::string& text, std::string_view field) {
  return text.empty() ? Digest() : digest_from(text, field);
}

double finite_from(double value, std::string_view field) {
  require(std::isfinite(value), field, "is not finite");
  return value;
}

// Throws before anything is allocated for it.
void require_frame(const wire::FrameSummary& w) {
  require_cells(w);
  require(static_cast<std::size_t>(w.errors_size()) <= kMaxErrors, "errors", "too many entries");
  for (const float error : w.errors()) finite_from(error, "errors");
  whole_from(w.tiles(), 0, kMaxTiles, "tiles");
  whole_from(w.tiles_done(), 0, w.tiles(), "tiles_done");
}

}  // namespace

std::string line(std::string text) {
  if (text.size() > kMaxLine) text.resize(kMaxLine);
  return text;
}

std::int64_t time_from(std::int64_t ms, std::string_view field) {
  require(ms >= 0, field, "is not a time");
  return ms;
}

void to_wire(JobSummary&& s, wire::JobSummary& w) {
  w.set_number(s.number);
  w.set_job(std::move(s.job));
  w.set_name(std::move(s.name));
  w.set_owner(std::move(s.owner));
  w.set_state(static_cast<int>(s.state));
  w.set_reason(line(std::move(s.reason)));
  w.set_priority(s.priority);
  w.set_frames(s.frames);
  w.set_frames_done(s.frames_done);
  w.set_frames_failed(s.frames_failed);
  w.set_submitted(s.submitted);
  w.set_fraction(s.fraction);
  w.set_seconds(s.seconds);
  if (s.seconds_left) w.set_seconds_left(*s.seconds_left);
  w.set_pixel_samples(s.pixel_samples);
  w.set_failed_tasks(s.failed_tasks);
}

void to_wire(FrameSummary&& s, wire::FrameSummary& w, std::size_t& room) {
  w.set_frame(s.frame);
  w.set_state(static_cast<int>(s.state));
  w.set_reason(line(std::move(s.reason)));
  w.set_round(s.round);
  w.set_tiles_done(s.tiles_done);
  w.set_tiles(s.tiles);
  w.set_fraction(s.fraction);
  w.set_acceptable_share(s.acceptable_share);
  w.set_seconds(s.seconds);
  if (s.error) w.set_error(*s.error);
  if (s.target) w.set_target(*s.target);
  const std::size_t errors = std::min(s.errors.size(), kMaxErrors);
  w.mutable_errors()->Add(s.errors.end() - static_cast<std::ptrdiff_t>(errors), s.errors.end());
  put_cells(s, w, room);
  w.set_image(std::move(s.image));
  w.set_preview(std::move(s.preview));
}

void to_wire(WorkerSummary&& s, wire::WorkerSummary& w) {
  w.set_id(std::move(s.id));
  w.set_name(std::move(s.name));
  w.set_device_class(std::move(s.device_class));
  w.set_slots(s.slots);
  w.set_held(s.held);
  w.set_tasks_per_second(s.tasks_per_second);
  w.set_done(s.done);
  w.set_failed(s.failed);
  w.set_set_aside(line(std::move(s.set_aside)));
}

JobSummary summary_from(const wire::JobSummary& w) {
  require(w.number() > 0, "number", "begins at 1");
  require(std::uint64_t{w.frames_done()} + w.frames_failed() <= w.frames(), "frames_done",
          "more than there are");
  JobSummary s{.number = w.number(),
               .job = job_name_from(w.job()),
               .name = text_from(w.name(), kMaxName, "name"),
               .owner = text_from(w.owner(), kMaxName, "owner"),
               .state = static_cast<JobState>(
                   whole_from(w.state(), 0, static_cast<int>(JobState::cancelled), "state")),
               .reason = text_from(w.reason(), kMaxLine, "reason"),
               .priority = whole_from(w.priority(), 0, kHighestPriority, "priority"),
               .frames = w.frames(),
               .frames_done = w.frames_done(),
               .frames_failed = w.frames_failed(),
               .submitted = time_from(w.submitted(), "submitted"),
               .fraction = share_from(w.fraction(), "fraction"),
               .seconds = seconds_from(w.seconds(), "seconds"),
               .seconds_left = {},
               .pixel_samples = w.pixel_samples(),
               .failed_tasks = w.failed_tasks()};
  if (w.has_seconds_left()) s.seconds_left = seconds_from(w.seconds_left(), "seconds_left");
  return s;
}

FrameSummary summary_from(const wire::FrameSummary& w) {
  require_frame(w);
  FrameSummary s{.frame = w.frame(),
                 .state = static_cast<FrameState>(
                     whole_from(w.state(), 0, static_cast<int>(FrameState::failed), "state")),
                 .reason = text_from(w.reason(), kMaxLine, "reason"),
                 .round = whole_from(w.round(), 0, kMaxRounds, "round"),
                 .tiles_done = w.tiles_done(),
                 .tiles = w.tiles(),
                 .fraction = share_from(w.fraction(), "fraction"),
                 .acceptable_share = share_from(w.acceptable_share(), "acceptable_share"),
                 .seconds = seconds_from(w.seconds(), "seconds"),
                 .error = {},
                 .target = {},
                 .errors = {w.errors().begin(), w.errors().end()},
                 .columns = w.columns(),
                 .cells = std::vector<CellStatus>(w.cells().size()),
                 .image = digest_or_none(w.image(), "image"),
                 .preview = digest_or_none(w.preview(), "preview")};
  if (w.has_error()) s.error = finite_from(w.error(), "error");
  if (w.has_target()) s.target = finite_from(w.target(), "target");
  std::ranges::transform(w.cells(), s.cells.begin(), [](char c) { return static_cast<CellStatus>(c); });
  return s;
}

WorkerSummary summary_from(const wire::WorkerSummary& w) {
  require(is_peer(w.id()), "id", "is no worker's id");
  return {.id = w.id(),
          .name = text_from(w.name(), kMaxName, "name"),
          .device_class = text_from(w.device_class(), kMaxName, "device_class"),
          .slots = whole_from(w.slots(), 0, kMaxSlots, "slots"),
          .held = whole_from(w.held(), 0, kMaxHeld, "held"),
          .tasks_per_second = seconds_from(w.tasks_per_second(), "tasks_per_second"),
          .done = w.done(),
          .failed = w.failed(),
          .set_aside = text_from(w.set_aside(), kMaxLine, "set_aside")};
}

}  // namespace tessera
