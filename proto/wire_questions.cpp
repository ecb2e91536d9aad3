// SPDX-License-Identifier: Apache-2.0
#include "proto/wire_questions.h"

#include "proto/codec.h"
#include "proto/wire_values.h"

namespace tessera {
namespace {

struct Writer {
  wire::Ask& out;

  void operator()(WhichLack& q) const {
    wire::WhichLack& w = *out.mutable_which_lack();
    for (Digest& blob : q.blobs) w.add_blobs(std::move(blob));
  }
  void operator()(PutPiece& q) const {
    wire::Piece& w = *out.mutable_put_piece();
    w.set_blob(std::move(q.blob));
    w.set_size(q.size);
    w.set_offset(q.offset);
    w.set_bytes(std::move(q.bytes));
  }
  void operator()(GetPiece& q) const {
    out.mutable_get_piece()->set_blob(std::move(q.blob));
    out.mutable_get_piece()->set_offset(q.offset);
  }
  void operator()(Submit& q) const {
    out.mutable_submit()->set_job(std::move(q.job));
    out.mutable_submit()->set_submission(std::move(q.submission));
  }
  void operator()(ListJobs& q) const { out.mutable_list_jobs()->set_after(q.after); }
  void operator()(ShowJob& q) const {
    out.mutable_show_job()->set_job(std::move(q.job));
    out.mutable_show_job()->set_from(q.from);
    out.mutable_show_job()->set_previews(q.previews);
    out.mutable_show_job()->set_seen(q.seen);
  }
  void operator()(ListEvents& q) const {
    out.mutable_list_events()->set_job(std::move(q.job));
    out.mutable_list_events()->set_after(q.after);
  }
  void operator()(Control& q) const {
    wire::Control& w = *out.mutable_control();
    w.set_job(std::move(q.job));
    w.set_verb(static_cast<int>(q.verb));
    w.set_value(q.value);
  }
  void operator()(ListWorkers& q) const { out.mutable_list_workers()->set_after(std::move(q.after)); }
  void operator()(ReleaseWorker& q) const { out.mutable_release_worker()->set_worker(std::move(q.worker)); }
};

WhichLack which_lack(const wire::WhichLack& w) {
  require(static_cast<std::size_t>(w.blobs_size()) <= kMaxListed, "blobs", "too many entries");
  WhichLack q;
  q.blobs.reserve(w.blobs_size());
  for (const std::string& blob : w.blobs()) q.blobs.push_back(digest_from(blob, "blobs"));
  return q;
}

PutPiece put_piece(wire::Piece& w) {
  require_piece(w);
  return {digest_from(w.blob(), "blob"), w.size(), w.offset(), std::move(*w.mutable_bytes())};
}

GetPiece get_piece(const wire::Piece& w) {
  require(w.size() == 0 && w.bytes().empty(), "bytes", "a piece that is wanted has none");
  require(w.offset() <= kMaxBlobBytes, "offset", "beyond the largest blob");
  return {digest_from(w.blob(), "blob"), w.offset()};
}

int value_from(Verb verb, int value) {
  switch (verb) {
    case Verb::set_priority:
      return whole_from(value, 0, kHighestPriority, "value");
    case Verb::verify:
      return whole_from(value, 1, kMaxVerified, "value");
    default:
      return whole_from(value, 0, 0, "value");
  }
}

Control control(const wire::Control& w) {
  const auto verb = static_cast<Verb>(whole_from(w.verb(), 0, static_cast<int>(Verb::remove), "verb"));
  return {job_name_from(w.job()), verb, value_from(verb, w.value())};
}

ListWorkers list_workers(const wire::ListWorkers& w) {
  require(w.after().empty() || is_peer(w.after()), "after", "is no worker's id");
  return {w.after()};
}

ReleaseWorker release_worker(const wire::ReleaseWorker& w) {
  require(is_peer(w.worker()), "worker", "is no worker's id");
  return {w.worker()};
}

Question question_from(wire::Ask& w) {
  switch (w.question_case()) {
    case wire::Ask::kWhichLack:
      return which_lack(w.which_lack());
    case wire::Ask::kPutPiece:
      return put_piece(*w.mutable_put_piece());
    case wire::Ask::kGetPiece:
      return get_piece(w.get_piece());
    case wire::Ask::kSubmit:
      return Submit{job_name_from(w.submit().job()), digest_from(w.submit().submission(), "submission")};
    case wire::Ask::kListJobs:
      return ListJobs{w.list_jobs().after()};
    case wire::Ask::kShowJob:
      return ShowJob{job_name_from(w.show_job().job()), w.show_job().from(), w.show_job().previews(),
                     w.show_job().seen()};
    case wire::Ask::kListEvents:
      return ListEvents{job_name_from(w.list_events().job()), w.list_events().after()};
    case wire::Ask::kControl:
      return control(w.control());
    case wire::Ask::kListWorkers:
      return list_workers(w.list_workers());
    case wire::Ask::kReleaseWorker:
      return release_worker(w.release_worker());
    default:
      throw ProtocolError("question", "no such question");
  }
}

}  // namespace

void to_wire(Ask&& ask, wire::Ask& w) {
  w.set_number(ask.number);
  std::visit(Writer{w}, ask.question);
}

Ask ask_from(wire::Ask& w) { return {w.number(), question_from(w)}; }

Digest digest_from(const std::string& text, std::string_view field) {
  require(is_digest(text), field, "is not 64 lower-case hexadecimal digits");
  return text;
}

JobName job_name_from(const std::string& text) {
  require(is_job_name(text), "job", "is no name of a job");
  return text;
}

void require_piece(const wire::Piece& w) {
  require(w.size() <= kMaxBlobBytes, "size", "larger than the largest blob");
  require(w.bytes().size() <= kPieceBytes, "bytes", "too long");
  require(w.offset() <= w.size() && w.bytes().size() <= w.size() - w.offset(), "offset",
          "the piece does not lie within its blob");
}

}  // namespace tessera
