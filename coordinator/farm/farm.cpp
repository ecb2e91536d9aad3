// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/farm.h"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <limits>
#include <random>
#include <utility>

#include "coordinator/farm/desk.h"
#include "proto/clock.h"

namespace tessera {
namespace {

constexpr Millis kLook{50};     // between looks at what may begin and which limits are reached
constexpr Millis kRest{1000};   // the same without jobs
constexpr Millis kTry{2000};    // between tries to go on after trouble with the store
constexpr int kTasksASlot = 2;  // that wait: fewer, and workers will soon have nothing to do
constexpr std::int64_t kCollection = 3600 * 1000;  // ms between collections of blobs that nobody needs

}  // namespace

Farm::Farm(Transport& road, FarmOptions options)
    : options_(std::move(options)),
      store_(options_.store, options_.blobs),
      coordinator_(road, prepared(options_.coordinator)),
      clerk_(options_.store / "writing", options_.blobs.sync, [this] { coordinator_.wake(); }),
      began_(clock_now()) {
  recover();
}

Farm::~Farm() = default;

CoordinatorOptions Farm::prepared(CoordinatorOptions options) {
  options.answer = [this](const Question& question, const Identity& who) {
    return answer(*this, question, who);
  };
  options.may_wait = [this](const Question& question) { return tessera::may_wait(*this, question); };
  // By chance, and far apart: workers may still be at what an earlier life has numbered.
  if (options.first_id == 1) options.first_id += (std::uint64_t{std::random_device{}()} >> 1) << 32;
  return options;
}

void Farm::run() {
  while (!stopped_) turn(clock_now() + std::chrono::seconds(1));
}

void Farm::stop() {
  stopped_ = true;
  coordinator_.wake();
}

void Farm::turn(Instant until) {
  coordinator_.turn(std::min(until, next_look_));
  for (Written& written : clerk_.done()) unfiled_.push_back(std::move(written));
  const Instant now = clock_now();
  look_at_trouble(now);
  while (trouble_.empty() && !unfiled_.empty()) file_next();
  if (std::exchange(changed_, false) || now >= next_look_) look(now);
  publish(now);
}

// At what may end, or begin.
void Farm::look(Instant now) {
  next_look_ = now + (open_.empty() ? kRest : kLook);
  end_jobs();
  draw_previews(now);
  keep_limits();
  if (trouble_.empty()) begin_jobs();
}

void Farm::have_trouble(const std::string& what) {
  if (trouble_.empty()) {
    spdlog::error("store: {}; nothing goes on until it works again", what);
    for (const auto& [name, job] : open_)
      if (job.shot && job.record.state == JobState::active) coordinator_.pause(*job.shot);
  }
  trouble_ = what;
  next_try_ = clock_now() + kTry;
}

// Whether the store works again; and when it does, everything goes on.
void Farm::look_at_trouble(Instant now) {
  if (trouble_.empty() || now < next_try_) return;
  try {
    store_.blobs().put(std::string(1 << 20, 'x'));
    collect();
  } catch (const Error& e) {
    return have_trouble(e.what());
  }
  spdlog::warn("store: it works again");
  trouble_.clear();
  for (const auto& [name, job] : open_)
    if (job.shot && job.record.state == JobState::active) coordinator_.resume(*job.shot);
}

void Farm::collect() {
  const std::int64_t now = unix_ms();
  if (const std::uint64_t freed = store_.collect(now - options_.keep_unused.count()))
    spdlog::info("store: {} bytes of files that no job needs were let go", freed);
  next_collection_ = now + kCollection;
}

bool Farm::hungry() const {
  std::size_t slots = 0;
  for (const auto& [id, worker] : coordinator_.workers()) slots += worker.present ? worker.slots : 0;
  return coordinator_.scheduler().counts().waiting < kTasksASlot * slots;
}

double Farm::memory_free() const {
  double used = 0;
  for (const auto& [name, job] : open_)
    if (job.shot || job.writing > 0) used += job.bytes;
  return options_.memory - used;
}

void Farm::note(std::uint64_t job, const std::string& text) {
  spdlog::info("job {}: {}", job, text);
  try {
    store_.add_event(job, unix_ms(), text);
  } catch (const Error& e) {
    have_trouble(e.what());
  }
}

}  // namespace tessera
