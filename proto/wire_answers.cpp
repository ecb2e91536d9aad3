// SPDX-License-Identifier: Apache-2.0
#include "proto/wire_answers.h"

#include <algorithm>
#include <array>

#include "proto/codec.h"
#include "proto/wire_questions.h"
#include "proto/wire_summaries.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

// --- Out. ---

struct Writer {
  wire::Answer& out;

  void operator()(Agreed&) const { out.mutable_agreed(); }
  void operator()(Lacking& r) const {
    wire::Lacking& w = *out.mutable_lacking();
    for (Lacking::Blob& b : r.blobs) {
      wire::Lacking::Blob& blob = *w.add_blobs();
      blob.set_blob(std::move(b.blob));
      blob.set_have(b.have);
    }
  }
  void operator()(Piece& r) const {
    wire::Piece& w = *out.mutable_piece();
    w.set_blob(std::move(r.blob));
    w.set_size(r.size);
    w.set_offset(r.offset);
    w.set_bytes(std::move(r.bytes));
  }
  void operator()(JobList& r) const {
    wire::JobList& w = *out.mutable_jobs();
    for (JobSummary& s : r.jobs) to_wire(std::move(s), *w.add_jobs());
  }
  void operator()(JobDetail& r) const {
    wire::JobDetail& w = *out.mutable_job();
    to_wire(std::move(r.summary), *w.mutable_summary());
    w.set_from(r.from);
    w.set_stamp(r.stamp);
    std::size_t room = kMaxCells;
    for (FrameSummary& s : r.frames) to_wire(std::move(s), *w.add_frames(), room);
  }
  void operator()(EventList& r) const {
    wire::EventList& w = *out.mutable_events();
    for (JobEvent& e : r.events) {
      wire::JobEvent& event = *w.add_events();
      event.set_number(e.number);
      event.set_when(e.when);
      event.set_text(line(std::move(e.text)));
    }
  }
  void operator()(WorkerList& r) const {
    wire::WorkerList& w = *out.mutable_workers();
    for (WorkerSummary& s : r.workers) to_wire(std::move(s), *w.add_workers());
  }
  void operator()(Denied& r) const {
    out.mutable_denied()->set_code(static_cast<int>(r.code));
    out.mutable_denied()->set_reason(r.reason.substr(0, kMaxText));
  }
};

// --- In. ---

void require_listed(int count, std::string_view field) {
  require(static_cast<std::size_t>(count) <= kMaxListed, field, "too many entries");
}

Lacking lacking(const wire::Lacking& w) {
  require_listed(w.blobs_size(), "blobs");
  Lacking r;
  for (const wire::Lacking::Blob& b : w.blobs()) {
    require(b.have() <= kMaxBlobBytes, "have", "larger than the largest blob");
    r.blobs.push_back({digest_from(b.blob(), "blobs"), b.have()});
  }
  return r;
}

Piece piece(wire::Piece& w) {
  require_piece(w);
  return {digest_from(w.blob(), "blob"), w.size(), w.offset(), std::move(*w.mutable_bytes())};
}

JobList jobs_from(const wire::JobList& w) {
  require_listed(w.jobs_size(), "jobs");
  JobList r;
  for (const wire::JobSummary& s : w.jobs()) r.jobs.push_back(summary_from(s));
  return r;
}

JobDetail detail_from(const wire::JobDetail& w) {
  require_listed(w.frames_size(), "frames");
  std::size_t cells = 0;
  for (const wire::FrameSummary& s : w.frames()) cells += s.cells().size();
  require(cells <= kMaxCells, "cells", "too many");
  JobDetail r{summary_from(w.summary()), w.from(), {}, w.stamp()};
  for (const wire::FrameSummary& s : w.frames()) r.frames.push_back(summary_from(s));
  return r;
}

EventList events_from(const wire::EventList& w) {
  require_listed(w.events_size(), "events");
  EventList r;
  for (const wire::JobEvent& e : w.events()) {
    require(e.number() > 0, "number", "begins at 1");
    r.events.push_back({e.number(), time_from(e.when(), "when"), text_from(e.text(), kMaxLine, "text")});
  }
  return r;
}

WorkerList workers_from(const wire::WorkerList& w) {
  require_listed(w.workers_size(), "workers");
  WorkerList r;
  for (const wire::WorkerSummary& s : w.workers()) r.workers.push_back(summary_from(s));
  return r;
}

Denied denied(const wire::Denied& w) {
  constexpr std::array codes{ExitCode::internal_error, ExitCode::bad_usage,        ExitCode::bad_input,
                             ExitCode::out_of_memory,  ExitCode::no_device,        ExitCode::unreachable,
                             ExitCode::job_failed,     ExitCode::stopped_at_limit, ExitCode::interrupted};
  const auto code = std::ranges::find(codes, w.code(), [](ExitCode c) { return static_cast<int>(c); });
  require(code != codes.end(), "code", "is no reason to fail");
  return {*code, text_from(w.reason(), kMaxText, "reason")};
}

Reply reply_from(wire::Answer& w) {
  switch (w.reply_case()) {
    case wire::Answer::kAgreed:
      return Agreed{};
    case wire::Answer::kLacking:
      return lacking(w.lacking());
    case wire::Answer::kPiece:
      return piece(*w.mutable_piece());
    case wire::Answer::kJobs:
      return jobs_from(w.jobs());
    case wire::Answer::kJob:
      return detail_from(w.job());
    case wire::Answer::kEvents:
      return events_from(w.events());
    case wire::Answer::kWorkers:
      return workers_from(w.workers());
    case wire::Answer::kDenied:
      return denied(w.denied());
    default:
      throw ProtocolError("reply", "no such answer");
  }
}

}  // namespace

void to_wire(Answer&& answer, wire::Answer& w) {
  w.set_number(answer.number);
  std::visit(Writer{w}, answer.reply);
}

Answer answer_from(wire::Answer& w) { return {w.number(), reply_from(w)}; }

}  // namespace tessera
