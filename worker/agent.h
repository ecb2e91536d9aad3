// SPDX-License-Identifier: Apache-2.0
// How a worker behaves towards its coordinator. No sockets, threads or clocks: what came and what became of
// its slots go in, what to say and to do comes out. See docs/PROTOCOL.md.
#pragma once

#include <cstdint>
#include <deque>
#include <memory>
#include <optional>
#include <string>
#include <unordered_map>
#include <variant>
#include <vector>

#include "core/instant.h"
#include "core/job.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

struct AgentOptions {
  int slots = 1;  // tasks worked on at a time
  std::string version;
  std::string device_class;
  Millis hello_first{100}, hello_last{8'000};  // between Hellos: doubles from the first to the last
  Millis silence{600'000};        // without a word from the coordinator: is it still there, does it know us?
  std::optional<Millis> give_up;  // without a word for so long: stop; none: never
  std::string name;               // see Hello
};

// The fruit of a task; task and attempt are filled in by the agent.
using TaskResult = std::variant<RenderDone, FilterDone>;

// Why a worker ends.
enum class Farewell : std::uint8_t { asked, refused, unreachable };

class Agent {
 public:
  // News.
  struct Started {};
  struct Told {
    Message message;  // from the coordinator
  };
  struct Finished {  // the slot is free again, as it is after the next two
    int slot = 0;
    TaskResult result;
  };
  struct Broke {
    int slot = 0;
    std::string reason;
    bool bad_input = false;
  };
  struct Ended {  // cancelled
    int slot = 0;
  };
  struct StopRequested {};
  struct TimePassed {};
  using Event = std::variant<Started, Told, Finished, Broke, Ended, StopRequested, TimePassed>;

  // What to do.
  struct Send {
    Message message;
  };
  struct Start {
    int slot = 0;  // free until now; reports with Finished, Broke or Ended
    Task task;
    std::shared_ptr<const Job> job;  // shared, as the slot may be at work when the agent forgets the job
    FilterInput input;
  };
  struct Cancel {
    int slot = 0;
  };
  struct Stop {  // no slot is at work; nothing more is to be done
    Farewell why = Farewell::asked;
    std::string reason;
  };
  using Command = std::variant<Send, Start, Cancel, Stop>;

  explicit Agent(AgentOptions options) : options_(std::move(options)), slots_(options_.slots) {}

  // `now` never goes back.
  std::vector<Command> handle(Event event, Instant now);
  // When TimePassed is due.
  std::optional<Instant> next_deadline() const;

 private:
  enum class Phase : std::uint8_t { greeting, working, leaving, stopped };
  struct Slot {
    bool busy = false;
    bool cancelled = false;  // what comes of it is not wanted
    Task task;
    Attempt attempt = 0;
  };
  struct KnownJob {
    std::shared_ptr<const Job> job;
    std::uint64_t used = 0;
  };

  void on(Started&);
  void on(Told&);
  void on(Finished&);
  void on(Broke&);
  void on(Ended&);
  void on(StopRequested&);
  void on(TimePassed&);

  void hear(Welcome&);
  void hear(Refused&);
  void hear(JobOffer&);
  void hear(Assign&);
  void hear(Revoke&);
  void hear(JobOver&);
  void hear(Unknown&);
  template <class Other>
  void hear(Other&) {}  // what only workers say

  void send(Message message) { out_.push_back(Send{std::move(message)}); }
  bool staying() const { return phase_ == Phase::greeting || phase_ == Phase::working; }
  void greet();
  void hello();
  void beat();
  bool idle() const;
  void ask_for_jobs();
  void work();
  bool adopt(const Assign&);
  template <class Unwanted>
  void drop(Unwanted unwanted);
  void forget_idle_jobs();
  void leave(Farewell, std::string reason);
  void stop_if_idle();
  Slot release(int slot);

  AgentOptions options_;
  Phase phase_ = Phase::greeting;
  Farewell why_ = Farewell::asked;
  std::string reason_;
  Instant now_{}, last_word_{}, next_hello_{}, next_beat_{};
  Millis backoff_{0}, heartbeat_{1000}, idle_heartbeat_{1000};
  bool asking_ = false;  // a Welcome is due
  std::uint64_t uses_ = 0;
  std::vector<Slot> slots_;
  std::deque<Assign> queue_;
  std::unordered_map<JobId, KnownJob> jobs_;
  std::vector<Command> out_;
};

}  // namespace tessera
