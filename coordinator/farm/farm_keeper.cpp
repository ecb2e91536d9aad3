// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/farm_keeper.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <utility>

#include "coordinator/recovery.h"
#include "coordinator/store/kept_image.h"
#include "core/exr.h"
#include "core/filter/given.h"

namespace tessera {

FarmKeeper::FarmKeeper(Store& store, std::uint64_t number, std::vector<std::size_t> places,
                       std::vector<std::string> identities, std::vector<FrameRecord>& frames,
                       std::function<void(const std::string&)> trouble)
    : store_(store),
      number_(number),
      places_(std::move(places)),
      identities_(std::move(identities)),
      frames_(frames),
      trouble_(std::move(trouble)) {}

Keeper::Begun FarmKeeper::begin(std::size_t frame, const Job& job) {
  Planes planes;
  try {
    planes = planes_of(job);
  } catch (const Error& e) {
    return {{make_frame(job)}, {}, e.what()};
  }
  try {
    return recovered(frame, job, planes);
  } catch (const Error& e) {
    spdlog::error("store: frame {} of job {} begins anew: {}", job.frame, number_, e.what());
  }
  // What is there is not to be gone on with, now or later.
  try {
    store_.drop_journal(number_, place(frame));
    open_.erase(frame);
    return recovered(frame, job, planes);
  } catch (const Error& e) {
    trouble_(e.what());
  }
  open_.erase(frame);
  Begun begun{{make_frame(job, planes)}, {}};
  begun.work = begun.frame.frame->begin();
  return begun;
}

// Of a frame that is given; else null. They come from strangers, and may be gone or damaged by now.
Planes FarmKeeper::planes_of(const Job& job) {
  if (!job.given) return nullptr;
  BlobStore& blobs = store_.blobs();
  const Digest& blob = job.given->planes;
  const std::string name = "blob " + blob;
  if (!blobs.has(blob)) throw InputError(name, "is not here any more", "what is uploaded again");
  blobs.check(blob);
  const std::int64_t values = job.region().area() * filter_shape(job).taken;
  const ExrImage file = read_exr(blobs.path(blob), values);
  return std::make_shared<const Image>(given_planes(job.filter, file, job.region(), name));
}

Keeper::Begun FarmKeeper::recovered(std::size_t frame, const Job& job, const Planes& planes) {
  FrameRecord& record = frames_[places_[frame]];
  if (record.state != FrameState::active) {
    record.state = FrameState::active;  // first: a journal without it is taken for a stale one
    store_.save(number_, record);
  }
  Open& kept =
      open_.try_emplace(frame, Open{store_.journal(number_, place(frame), identities_[places_[frame]])})
          .first->second;
  const auto load = [this](const Digest& blob) {
    return std::make_shared<const Image>(get_image(store_.blobs(), blob));
  };
  RecoveredFrame r = recover(job, kept.journal, load, planes);
  if (!kept.journal.found().thrown_away.empty())
    spdlog::warn("store: frame {} of job {}: thrown away is {}", job.frame, number_,
                 kept.journal.found().thrown_away);
  std::vector<Work> work;
  if (!r.frame->round_complete()) work = r.frame->outstanding();
  return {{std::move(r.frame), r.seconds, r.dropped, std::move(r.device_classes), std::move(r.errors)},
          std::move(work)};
}

template <class Work>
void FarmKeeper::write(std::size_t frame, const Work& work) {
  const auto found = open_.find(frame);
  if (found == open_.end() || found->second.behind) return;
  try {
    work(found->second.journal);
  } catch (const Error& e) {
    found->second.behind = true;
    trouble_(e.what());
  }
}

void FarmKeeper::remembers(std::size_t frame, const std::shared_ptr<const Image>& history) {
  write(frame, [&](Journal& journal) { journal.append(Remembered{keep(history)}); });
}

void FarmKeeper::takes(std::size_t frame, Accepted&& result, const Image& pixels) {
  write(frame, [&](Journal& journal) { journal.append(result, pixels); });
}

void FarmKeeper::looked(std::size_t frame, const FrameUnderWay& state, double seconds) {
  write(frame, [&](Journal& journal) { journal.append(Looked{seconds}); });
  const auto found = open_.find(frame);
  if (found == open_.end()) return;
  if (!found->second.behind && !found->second.journal.checkpoint_due(frame_bytes(state.frame->job()))) return;
  try {
    store_.checkpoint(number_, place(frame), found->second.journal,
                      {state.frame->snapshot(), seconds, state.dropped, state.device_classes, state.errors});
    found->second.behind = false;
  } catch (const Error& e) {
    found->second.behind = true;
    trouble_(e.what());
  }
}

Digest FarmKeeper::keep(const std::shared_ptr<const Image>& history) {
  if (!history) return {};
  if (history != last_kept_) {
    last_blob_ = put_image(store_.blobs(), *history);
    last_kept_ = history;
  }
  return last_blob_;
}

void FarmKeeper::end(std::size_t frame) {
  const FrameRecord& record = frames_[places_[frame]];
  auto ended = open_.extract(frame);
  if (ended)
    store_.finish(number_, record, std::move(ended.mapped().journal));
  else
    store_.save(number_, record);
}

bool FarmKeeper::behind() const {
  return std::ranges::any_of(open_, [](const auto& o) { return o.second.behind; });
}

}  // namespace tessera
