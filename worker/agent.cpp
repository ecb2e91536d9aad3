// SPDX-License-Identifier: Apache-2.0
#include "worker/agent.h"

#include <algorithm>
#include <cassert>
#include <set>
#include <utility>

namespace tessera {
namespace {

constexpr std::size_t kMostJobs = 64;     // remembered; others are asked for again
constexpr std::size_t kMostTasks = 4096;  // in the queue; no coordinator in its right mind sends more

}  // namespace

std::vector<Agent::Command> Agent::handle(Event event, Instant now) {
  now_ = std::max(now_, now);
  std::visit([this](auto& e) { on(e); }, event);
  return std::exchange(out_, {});
}

std::optional<Instant> Agent::next_deadline() const {
  if (!staying()) return std::nullopt;
  Instant next = asking_ ? next_hello_ : last_word_ + options_.silence;
  if (phase_ == Phase::working) next = std::min(next, next_beat_);
  if (options_.give_up) next = std::min(next, last_word_ + *options_.give_up);
  return next;
}

void Agent::on(Started&) {
  last_word_ = now_;
  greet();
}

void Agent::on(Told& e) {
  if (!staying()) return;
  last_word_ = now_;
  std::visit([this](auto& message) { hear(message); }, e.message);
}

void Agent::on(Finished& e) {
  const Slot slot = release(e.slot);
  if (!slot.cancelled)
    std::visit(
        [&](auto& result) {
          result.task = slot.task.id;
          result.attempt = slot.attempt;
          send(std::move(result));
        },
        e.result);
  work();
}

void Agent::on(Broke& e) {
  const Slot slot = release(e.slot);
  if (!slot.cancelled) send(TaskFailed{slot.task.id, slot.attempt, std::move(e.reason), e.bad_input});
  work();
}

void Agent::on(Ended& e) {
  release(e.slot);
  work();
}

void Agent::on(StopRequested&) {
  if (!staying()) return;
  send(Goodbye{});
  leave(Farewell::asked, {});
}

void Agent::on(TimePassed&) {
  if (!staying()) return;
  if (options_.give_up && now_ - last_word_ >= *options_.give_up)
    return leave(Farewell::unreachable, "the coordinator does not answer");
  if (!asking_ && now_ - last_word_ >= options_.silence) greet();
  if (asking_ && now_ >= next_hello_) hello();
  if (phase_ == Phase::working && now_ >= next_beat_) beat();
}

void Agent::hear(Welcome& m) {
  phase_ = Phase::working;
  asking_ = false;
  heartbeat_ = m.heartbeat;
  idle_heartbeat_ = m.idle_heartbeat;
  // At once, as the coordinator may have forgotten what is in hand here.
  beat();
}

void Agent::hear(Refused& m) { leave(Farewell::refused, std::move(m.reason)); }

void Agent::hear(JobOffer& m) {
  jobs_[m.id] = {std::make_shared<const Job>(std::move(m.job)), uses_++};
  work();
  forget_idle_jobs();
}

// Taken even before a Welcome, which may be the one that was lost.
void Agent::hear(Assign& m) {
  if (adopt(m) || queue_.size() >= kMostTasks) return;
  const JobId job = m.task.job;
  const bool asked = std::ranges::any_of(queue_, [job](const Assign& a) { return a.task.job == job; });
  if (!jobs_.contains(job) && !asked) send(NeedJob{job});
  if (idle()) next_beat_ = std::min(next_beat_, now_ + heartbeat_);
  queue_.push_back(std::move(m));
  work();
}

// A later attempt may have been revoked already, or be the next: an earlier Revoke is not about it.
void Agent::hear(Revoke& m) {
  drop([&m](const Task& task, Attempt attempt) { return task.id == m.task && attempt <= m.attempt; });
}

void Agent::hear(JobOver& m) {
  drop([&m](const Task& task, Attempt) { return task.job == m.id; });
  jobs_.erase(m.id);
}

void Agent::hear(Unknown&) {
  if (!asking_) greet();
}

void Agent::greet() {
  asking_ = true;
  backoff_ = options_.hello_first;
  hello();
}

void Agent::hello() {
  send(Hello{kProtocolVersion, options_.version, options_.device_class, options_.slots, options_.name});
  next_hello_ = now_ + backoff_;
  backoff_ = std::min(2 * backoff_, options_.hello_last);
}

void Agent::beat() {
  Heartbeat beat;
  for (const Slot& slot : slots_)
    if (slot.busy && !slot.cancelled) beat.held.push_back({slot.task.id, slot.attempt});
  for (const Assign& a : queue_) beat.held.push_back({a.task.id, a.attempt});
  send(std::move(beat));
  ask_for_jobs();
  next_beat_ = now_ + (idle() ? idle_heartbeat_ : heartbeat_);
}

bool Agent::idle() const { return queue_.empty() && std::ranges::none_of(slots_, &Slot::busy); }

void Agent::ask_for_jobs() {
  std::set<JobId> missing;
  for (const Assign& a : queue_)
    if (!jobs_.contains(a.task.job)) missing.insert(a.task.job);
  for (const JobId id : missing) send(NeedJob{id});
}

// Gives every free slot the first task whose job is known.
void Agent::work() {
  if (!staying()) return stop_if_idle();
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    if (slots_[i].busy) continue;
    const auto next =
        std::ranges::find_if(queue_, [this](const Assign& a) { return jobs_.contains(a.task.job); });
    if (next == queue_.end()) return;
    KnownJob& known = jobs_.at(next->task.job);
    known.used = uses_++;
    slots_[i] = {true, false, next->task, next->attempt};
    out_.emplace_back(Start{static_cast<int>(i), next->task, known.job, std::move(next->input)});
    queue_.erase(next);
  }
}

// A task in hand that is assigned anew keeps its place, under the new attempt.
bool Agent::adopt(const Assign& m) {
  for (Slot& slot : slots_)
    if (slot.busy && !slot.cancelled && slot.task.id == m.task.id) {
      slot.attempt = std::max(slot.attempt, m.attempt);
      return true;
    }
  const auto queued = std::ranges::find(queue_, m.task.id, [](const Assign& a) { return a.task.id; });
  if (queued == queue_.end()) return false;
  queued->attempt = std::max(queued->attempt, m.attempt);
  return true;
}

template <class Unwanted>
void Agent::drop(Unwanted unwanted) {
  std::erase_if(queue_, [&](const Assign& a) { return unwanted(a.task, a.attempt); });
  for (std::size_t i = 0; i < slots_.size(); ++i) {
    Slot& slot = slots_[i];
    if (!slot.busy || slot.cancelled || !unwanted(slot.task, slot.attempt)) continue;
    slot.cancelled = true;
    out_.push_back(Cancel{static_cast<int>(i)});
  }
}

// The coordinator's word that a job is over may be lost.
void Agent::forget_idle_jobs() {
  while (jobs_.size() > kMostJobs)
    jobs_.erase(std::ranges::min_element(jobs_, {}, [](const auto& known) { return known.second.used; }));
}

void Agent::leave(Farewell why, std::string reason) {
  phase_ = Phase::leaving;
  why_ = why;
  reason_ = std::move(reason);
  drop([](const Task&, Attempt) { return true; });
  stop_if_idle();
}

void Agent::stop_if_idle() {
  if (phase_ != Phase::leaving || std::ranges::any_of(slots_, &Slot::busy)) return;
  phase_ = Phase::stopped;
  out_.push_back(Stop{why_, reason_});
}

Agent::Slot Agent::release(int slot) {
  assert(slots_[slot].busy);
  return std::exchange(slots_[slot], {});
}

}  // namespace tessera
