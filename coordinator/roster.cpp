// SPDX-License-Identifier: Apache-2.0
#include "coordinator/roster.h"

#include <algorithm>
#include <cassert>
#include <utility>

namespace tessera {
namespace {

// Who did something right so lately is thought to be able to do more.
constexpr Millis kTrust{30'000};
// How long one that failed often gets nothing, while others of its class do things right.
constexpr Millis kTrial{10'000};
// Names that are away are remembered for their failures, so many of them.
constexpr std::size_t kMostAway = 4096;
// How many steady names are looked at for one that may do a task.
constexpr int kWindow = 64;

void take_out(std::map<const book::Name*, int>& counts, const book::Name* name) {
  const auto it = counts.find(name);
  if (--it->second == 0) counts.erase(it);
}

}  // namespace

// --- Workers. ---

Roster::Worker* Roster::worker(const WorkerId& id) {
  const auto it = workers_.find(id);
  return it == workers_.end() ? nullptr : &it->second;
}

bool Roster::same(const Worker& worker, const Joined& e) const {
  return worker.device_class->name == e.device_class &&
         worker.name->name == (e.name.empty() ? e.worker : e.name);
}

Roster::Worker& Roster::join(const Joined& e) {
  assert(e.slots >= 1);
  const auto [it, fresh] = workers_.try_emplace(e.worker);
  Worker& worker = it->second;
  if (fresh) {
    worker.id = e.worker;
    worker.number = ++joins_;
    worker.by_word = by_word_[0].insert(by_word_[0].end(), &worker);
    worker.device_class = &use_class(e.device_class);
    worker.name = &name_of(e);
    worker.name->workers.push_back(&worker);
    if (worker.able()) enable(worker);
  }
  worker.slots = e.slots;
  worker.scenes = {};
  hear(worker);
  return worker;
}

void Roster::hear(Worker& worker) {
  worker.prompted = false;
  quiet_from_now(worker, worker.held() > 0);
}

void Roster::prompt(Worker& worker) {
  if (!std::exchange(worker.prompted, true)) quiet_from_now(worker, false);
}

void Roster::quiet_from_now(Worker& worker, bool at_work) {
  worker.last_word = now_;
  auto& before = by_word_[worker.at_work];
  worker.at_work = at_work;
  by_word_[at_work].splice(by_word_[at_work].end(), before, worker.by_word);
}

Millis Roster::patience(bool at_work) const {
  return options_.silence * (at_work ? 1 : options_.idle_patience);
}

Roster::Worker* Roster::overdue() const {
  for (const bool at_work : {true, false}) {
    const auto& workers = by_word_[at_work];
    if (!workers.empty() && workers.front()->last_word + patience(at_work) <= now_) return workers.front();
  }
  return nullptr;
}

std::optional<Instant> Roster::next_deadline() const {
  std::optional<Instant> next;
  for (const bool at_work : {true, false})
    if (const auto& workers = by_word_[at_work]; !workers.empty()) {
      const Instant one = workers.front()->last_word + patience(at_work);
      next = next ? std::min(*next, one) : one;
    }
  return next;
}

void Roster::retire(Worker& worker) {
  assert(worker.held() == 0 && !worker.gone);
  if (worker.able()) disable(worker);
  worker.gone = true;
  leave_name(worker);
  ++retired_;
}

void Roster::forget(Worker& worker) {
  assert(worker.held() == 0);
  if (!worker.gone) retire(worker);
  --retired_;
  by_word_[worker.at_work].erase(worker.by_word);
  drop_class(*worker.device_class);
  workers_.erase(WorkerId(worker.id));
}

void Roster::enable(Worker& worker) {
  ++worker.device_class->able[worker.name];
  ++able_[worker.name];
}

void Roster::disable(Worker& worker) {
  take_out(worker.device_class->able, worker.name);
  take_out(able_, worker.name);
}

Roster::DeviceClass& Roster::use_class(const std::string& name) {
  DeviceClass& kind = classes_[name];
  kind.name = name;
  ++kind.users;
  return kind;
}

void Roster::drop_class(DeviceClass& kind) {
  if (--kind.users == 0) classes_.erase(std::string(kind.name));
}

// --- Names. ---

Roster::Name& Roster::name_of(const Joined& e) {
  const std::string& key = e.name.empty() ? e.worker : e.name;
  Name& name = names_[key];
  name.name = key;
  if (std::exchange(name.away, false)) away_.erase(name.place);
  return name;
}

// Without workers it is forgotten, unless something is held against it.
void Roster::leave_name(Worker& worker) {
  Name& name = *worker.name;
  std::erase(name.workers, &worker);
  if (!name.workers.empty()) return;
  unsteady(name);
  name.away = true;
  name.place = away_.insert(away_.end(), &name);
  const bool clean = name.set_aside.empty() && name.last_failure.empty();
  Name* leaves = clean ? &name : away_.size() > kMostAway ? away_.front() : nullptr;
  if (!leaves) return;
  if (!leaves->set_aside.empty()) --set_aside_;
  away_.erase(leaves->place);
  names_.erase(std::string(leaves->name));
}

Roster::Name* Roster::name(const std::string& id_or_name) {
  if (const auto it = names_.find(id_or_name); it != names_.end()) return &it->second;
  const Worker* found = worker(id_or_name);
  return found && !found->gone ? found->name : nullptr;
}

void Roster::set_aside(Name& name, const std::string& why) {
  assert(name.set_aside.empty() && !why.empty());
  for (Worker* worker : name.workers) disable(*worker);
  name.set_aside = why;
  ++set_aside_;
}

void Roster::release(Name& name) {
  if (name.set_aside.empty()) return;
  name.set_aside.clear();
  name.proven.clear();
  name.row = 0;
  --set_aside_;
  for (Worker* worker : name.workers) enable(*worker);
}

void Roster::unsteady(Name& name) {
  if (std::exchange(name.steady, false)) steady_.erase(name.place);
}

void Roster::succeeded(Name& name) {
  name.tried = true;
  name.proven.clear();
  name.last_failure.clear();
  name.last_success = now_;
  name.row = 0;
  if (name.away) return;
  if (std::exchange(name.steady, true))
    steady_.splice(steady_.end(), steady_, name.place);
  else
    name.place = steady_.insert(steady_.end(), &name);
}

void Roster::failed(Name& name, const std::string& reason, std::uint64_t incident) {
  unsteady(name);
  if (std::exchange(name.last_incident, incident) != incident) ++name.row;
  name.last_failed = now_;
  name.last_failure = reason.empty() ? "no reason given" : reason;
}

bool Roster::convict(Name& name, std::uint64_t incident) {
  if (options_.set_aside_after <= 0 || !name.set_aside.empty()) return false;
  name.proven.insert(incident);
  const bool others = able_.size() > (name.able() ? 1 : 0);
  return others && name.proven.size() >= static_cast<std::size_t>(options_.set_aside_after);
}

// --- Who may do what. ---

bool Roster::excluded(const Name& name, const book::Terms& terms) const {
  if (std::ranges::binary_search(terms.failed_on, name.name)) return true;
  if (terms.avoid.empty()) return false;
  return terms.avoid == name.name || (name.workers.size() == 1 && name.workers.front()->id == terms.avoid);
}

bool Roster::anybody_else(const book::Terms& terms) const {
  const auto& able = terms.device_class ? terms.device_class->able : able_;
  return std::ranges::any_of(able, [&](const auto& entry) { return !excluded(*entry.first, terms); });
}

bool Roster::anybody_steady(const book::Terms& terms) const {
  int looked = 0;
  for (auto it = steady_.rbegin(); it != steady_.rend() && ++looked <= kWindow; ++it) {
    const Name& name = **it;
    if (now_ - name.last_success > kTrust) return false;
    const bool right_class = !terms.device_class || terms.device_class->able.contains(&name);
    if (right_class && name.able() && !excluded(name, terms)) return true;
  }
  return false;
}

bool Roster::on_trial(const Worker& worker) const {
  const Name& name = *worker.name;
  return options_.set_aside_after > 0 && name.row >= options_.set_aside_after &&
         now_ - name.last_failed < kTrial && anybody_steady({worker.device_class, {}, {name.name}});
}

// A task that failed does not go to one that failed at its last, if anybody is known to do things right:
// where many workers are broken at the same time, they would else fail it for good.
bool Roster::may_have_special(const Worker& worker, const book::Terms& terms) const {
  if (!terms.avoid.empty() && (terms.avoid == worker.id || terms.avoid == worker.name->name)) return false;
  if (terms.failed_on.empty()) return true;
  if (std::ranges::binary_search(terms.failed_on, worker.name->name)) return !anybody_else(terms);
  return worker.name->row == 0 || !anybody_steady(terms);
}

}  // namespace tessera
