// SPDX-License-Identifier: Apache-2.0
// What waits, and whose turn it is. Bands come strictly one after the other. Within a band flows share by
// start-time fair queueing (Goyal, Vin, Cheng 1996): each has a tag, the virtual time at which its next task
// begins, which grows by the cost of what it gets; the lowest tag is next. A flow that comes back begins at
// the present virtual time, so it has saved nothing up. Within a flow tasks go by rank, then by submission.
//
// A worker that has a scene loaded may be given a task of it instead, out of a flow whose tag is higher by
// `affinity_slack` at most. So of two flows that wait all the time, from equal tags on, neither gets more
// than affinity_slack + the cost of one task beyond what the other gets.
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <set>
#include <string>
#include <tuple>
#include <unordered_map>

#include "coordinator/records.h"
#include "coordinator/roster.h"

namespace tessera {

namespace book {

struct Band;
struct Flow;
struct Shelf;

using LaneKey = std::tuple<double, std::uint64_t, Lane*>;         // tag and number of its flow
using LineKey = std::tuple<std::uint64_t, std::uint64_t, Line*>;  // rank, and order of its first task

// What of a flow stands on one shelf.
struct Lane {
  Flow* flow = nullptr;
  Shelf* shelf = nullptr;
  std::set<LineKey> lines;
  bool shelved = false;  // listed there, under
  double tag = 0;
  std::uint64_t scene = 0;
};
struct Flow {
  Band* band = nullptr;
  std::string name;
  std::uint64_t number = 0;  // in order of coming
  double tag = 0;
  std::map<Shelf*, Lane> lanes;
  bool idle = false;
};
// What of a band the same workers may do.
struct Shelf {
  Band* band = nullptr;
  Terms terms;
  std::set<LaneKey> lanes;
  std::unordered_map<std::uint64_t, std::set<LaneKey>> by_scene;  // of the first task of each lane
};
struct Band {
  int number = 0;
  double now = 0;  // virtual time
  std::unordered_map<std::string, Flow> flows;
  std::set<std::pair<double, Flow*>> idle;  // flows without tasks whose tags are still to come
  std::map<Terms, Shelf> shelves;
};

}  // namespace book

class Waiting {
 public:
  using Job = book::Job;
  using Task = book::Task;

  // `roster` is borrowed.
  Waiting(const Roster& roster, double affinity_slack) : roster_(roster), slack_(affinity_slack) {}
  Waiting(const Waiting&) = delete;
  Waiting& operator=(const Waiting&) = delete;

  void add(Task&);     // Precondition: it does not wait
  void remove(Task&);  // Precondition: it waits
  void give(Task&);    // remove(), and its flow pays for it
  // Standing, pause and class of a job change only while it is not listed. A new one is not.
  void unlist(Job&);
  void list(Job&);

  // What this worker should do next; null: nothing that waits is for it.
  Task* first_for(const book::Worker&);
  bool empty() const { return bands_.empty(); }  // but for paused jobs
  // Something waits for this class that some of its workers must not do.
  bool special(const book::DeviceClass&) const;

 private:
  void list(book::Line&);
  void unlist(book::Line&);
  void pull(Task&, book::Line&);
  void shelve(book::Lane&);
  void unshelve(book::Lane&);
  void tidy(book::Flow&);
  book::Flow& flow_of(book::Band&, const std::string& name);
  book::Lane* first_lane(book::Band&, const book::Worker&);
  book::Lane* warm_lane(book::Band&, const book::Worker&, double tag_limit);
  book::Lane* first_of(book::Flow&, const book::Worker&);

  const Roster& roster_;
  double slack_;
  std::uint64_t flows_ = 0;
  std::map<int, book::Band, std::greater<>> bands_;
};

}  // namespace tessera
