// SPDX-License-Identifier: Apache-2.0
// Who is there: workers, the names that failures are counted by, device classes; and who may do what.
#pragma once

#include <array>
#include <cstdint>
#include <list>
#include <map>
#include <optional>
#include <string>
#include <unordered_map>

#include "coordinator/records.h"

namespace tessera {

class Roster {
 public:
  using DeviceClass = book::DeviceClass;
  using Name = book::Name;
  using Worker = book::Worker;

  explicit Roster(const SchedulerOptions& options) : options_(options) {}
  Roster(const Roster&) = delete;
  Roster& operator=(const Roster&) = delete;

  // What follows happens now, which never goes back.
  void set_time(Instant now) { now_ = now; }

  Worker* worker(const WorkerId&);
  // A new one, or new slots for a known one. Precondition: a known one is not gone, and of this class and
  // name.
  Worker& join(const Joined&);
  bool same(const Worker&, const Joined&) const;
  void hear(Worker&);
  // It gets something to do after it had nothing: should that be lost on the way, it will say so at its next
  // word, which is far; so its silence counts from now. Once after each word of its.
  void prompt(Worker&);
  void retire(Worker&);  // gone. Precondition: it was not, and holds nothing
  void forget(Worker&);  // Precondition: holds nothing
  // Silent for too long; null: nobody is before next_deadline().
  Worker* overdue() const;
  std::optional<Instant> next_deadline() const;
  std::size_t present() const { return workers_.size() - retired_; }
  const std::unordered_map<WorkerId, Worker>& workers() const { return workers_; }

  // Device classes are remembered while somebody uses them.
  DeviceClass& use_class(const std::string& name);
  void drop_class(DeviceClass&);
  std::map<std::string, DeviceClass>& classes() { return classes_; }

  // Names.
  Name* name(const std::string& id_or_name);
  void set_aside(Name&, const std::string& why);
  void release(Name&);
  std::size_t set_aside() const { return set_aside_; }
  void succeeded(Name&);
  void failed(Name&, const std::string& reason, std::uint64_t incident);
  // Somebody else did what failed there. True: it has failed so often that it should be set aside.
  bool convict(Name&, std::uint64_t incident);

  bool may_have(const Worker& worker, const book::Terms& terms) const {
    if (terms.device_class && terms.device_class != worker.device_class) return false;
    return terms.plain() || may_have_special(worker, terms);
  }
  // It failed so often that it gets nothing for now: whether it is to blame turns out when others have done,
  // or failed at, what it could not.
  bool on_trial(const Worker&) const;
  // Somebody may do it who has not failed at it.
  bool anybody_else(const book::Terms&) const;

 private:
  void quiet_from_now(Worker&, bool at_work);
  Millis patience(bool at_work) const;
  bool may_have_special(const Worker&, const book::Terms&) const;
  bool anybody_steady(const book::Terms&) const;
  bool excluded(const Name&, const book::Terms&) const;
  void enable(Worker&);
  void disable(Worker&);
  void leave_name(Worker&);
  Name& name_of(const Joined&);
  void unsteady(Name&);

  SchedulerOptions options_;
  Instant now_{};
  std::uint64_t joins_ = 0;
  std::size_t retired_ = 0, set_aside_ = 0;
  std::unordered_map<WorkerId, Worker> workers_;
  std::array<std::list<Worker*>, 2> by_word_;  // idle, at work; the quietest first
  std::map<std::string, DeviceClass> classes_;
  std::unordered_map<std::string, Name> names_;
  std::map<const Name*, int> able_;  // workers of each that may be given tasks
  std::list<Name*> steady_;          // who did something right the longest ago first
  std::list<Name*> away_;            // remembered for what they did; who left first comes first
};

}  // namespace tessera
