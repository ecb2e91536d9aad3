// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/desk.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>

#include "proto/clock.h"
#include "proto/rights.h"

namespace tessera {
namespace {

constexpr int kUsualPriority = 50;         // what submitters may ask for at most
constexpr std::size_t kFramesAtOnce = 64;  // each may come with the states of its cells

void require(bool may, const Identity& who, std::string_view what) {
  if (!may) throw Error(ExitCode::bad_usage, fmt::format("the key of {} may not {}", who.name, what));
}

struct Desk {
  Farm& farm;
  const Identity& who;

  BlobStore& blobs() { return farm.store().blobs(); }
  Reply operator()(const WhichLack& q) {
    Lacking lacking;
    for (const Digest& blob : q.blobs)
      if (const auto known = blobs().known(blob); !known.whole) lacking.blobs.push_back({blob, known.have});
    return lacking;
  }
  Reply operator()(const PutPiece& q) {
    if (!farm.trouble().empty()) throw StoreFull(farm.store().folder(), farm.trouble());
    const std::uint64_t have = blobs().take_piece(q.blob, q.size, q.offset, q.bytes);
    if (have >= q.offset + q.bytes.size()) return Agreed{};
    return Lacking{{{q.blob, have}}};
  }
  Reply operator()(const GetPiece& q) {
    if (const Previews::Png png = farm.preview(q.blob)) {
      if (q.offset > png->size()) throw InputError("blob " + q.blob, "ends before that piece");
      return Piece{q.blob, png->size(), q.offset, png->substr(q.offset, kPieceBytes)};
    }
    if (!blobs().has(q.blob)) throw InputError("blob " + q.blob, "is not here");
    return Piece{q.blob, blobs().size(q.blob), q.offset, blobs().read_piece(q.blob, q.offset, kPieceBytes)};
  }
  Reply operator()(const Submit& q) {
    farm.submit(q.job, q.submission, who.name, who.administrator ? kHighestPriority : kUsualPriority);
    return Agreed{};
  }
  Reply operator()(const ListJobs& q) {
    JobList list;
    for (const JobRecord& record : farm.store().jobs(q.after, kMaxListed))
      list.jobs.push_back(farm.summary(farm.record(record.job)));
    return list;
  }
  Reply operator()(const ShowJob& q) {
    const JobRecord record = farm.record(q.job);
    return JobDetail{farm.summary(record), q.from, farm.frames(record, q.from, kFramesAtOnce, q.previews),
                     farm.stamp(q.job)};
  }
  Reply operator()(const ListEvents& q) {
    return EventList{farm.store().events(farm.record(q.job).number, q.after, kMaxListed)};
  }
  Reply operator()(const Control& q) {
    if (q.verb == Verb::remove && !farm.store().job(q.job)) return Agreed{};
    const JobRecord record = farm.record(q.job);
    const bool own = who.submitter && record.owner == who.name;
    require(own || who.administrator, who, fmt::format("change job {}, which is {}'s", q.job, record.owner));
    switch (q.verb) {
      case Verb::cancel:
        farm.cancel(q.job, who.name);
        break;
      case Verb::pause:
        farm.pause(q.job);
        break;
      case Verb::resume:
        farm.resume(q.job);
        break;
      case Verb::set_priority:
        require(who.administrator || q.value <= kUsualPriority, who, "give priorities above 50");
        farm.set_priority(q.job, q.value);
        break;
      case Verb::verify:
        farm.verify(q.job, q.value, static_cast<std::uint64_t>(unix_ms()));
        break;
      case Verb::remove:
        farm.remove(q.job);
        break;
    }
    return Agreed{};
  }
  Reply operator()(const ListWorkers& q) {
    WorkerList list;
    auto workers = farm.coordinator().scheduler().workers();
    std::ranges::sort(workers, {}, &WorkerFigures::worker);
    for (const WorkerFigures& w : workers) {
      if (w.worker <= q.after || list.workers.size() == kMaxListed) continue;
      list.workers.push_back({.id = w.worker,
                              .name = w.name,
                              .device_class = w.device_class,
                              .slots = w.slots,
                              .held = w.held,
                              .tasks_per_second = w.tasks_per_second,
                              .done = w.done,
                              .failed = w.failed,
                              .set_aside = w.set_aside});
    }
    return list;
  }
  Reply operator()(const ReleaseWorker& q) {
    farm.release(q.worker);
    return Agreed{};
  }
};

}  // namespace

Reply answer(Farm& farm, const Question& question, const Identity& who) {
  if (const auto why = why_not(who, question)) return Denied{ExitCode::bad_usage, *why};
  try {
    return std::visit(Desk{farm, who}, question);
  } catch (const Error& e) {
    return Denied{e.code(), e.what()};
  } catch (const std::exception& e) {
    spdlog::error("coordinator: a question of {} was not answered: {}", who.name, e.what());
    return Denied{ExitCode::internal_error, e.what()};
  }
}

bool may_wait(const Farm& farm, const Question& question) {
  const auto* q = std::get_if<ShowJob>(&question);
  return q && q->seen != 0 && q->seen == farm.stamp(q->job);
}

}  // namespace tessera
