// SPDX-License-Identifier: Apache-2.0
// What the coordinator makes of its mail, and how it carries out what the scheduler decides.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <algorithm>
#include <type_traits>

#include "coordinator/coordinator.h"

namespace tessera {
namespace {

constexpr std::size_t kMostRemembered = 20'000;  // workers, with those that left

std::uint64_t bytes_of(const FilterInput& input) {
  return (input.film.data().size() + input.history.data().size()) * sizeof(float);
}

}  // namespace

// Who may say what is the road's to see to (proto/rights.h).
void Coordinator::hear(Mail mail, Instant now) {
  if (auto* ask = std::get_if<Ask>(&mail.message)) return answer(mail.from, std::move(*ask), mail.who, now);
  hear_worker(mail.from, mail.message, now);
}

void Coordinator::hear_worker(const WorkerId& from, Message& any, Instant now) {
  std::visit(
      [&](auto& message) {
        using Kind = std::decay_t<decltype(message)>;
        if constexpr (std::is_same_v<Kind, Hello>)
          welcome(from, message, now);
        else if constexpr (std::is_same_v<Kind, Heartbeat>)
          tell(Heard{from, message.held}, now);
        else if constexpr (std::is_same_v<Kind, NeedJob>)
          answer(from, message, now);
        else if constexpr (std::is_same_v<Kind, RenderDone> || std::is_same_v<Kind, FilterDone>)
          take(from, message, now);
        else if constexpr (std::is_same_v<Kind, TaskFailed>)
          failed(from, message, now);
        else if constexpr (std::is_same_v<Kind, Goodbye>)
          leave(from, now);
        else
          spdlog::warn("coordinator: {} sent a message that only a coordinator sends", from);
      },
      any);
}

void Coordinator::welcome(const WorkerId& from, const Hello& hello, Instant now) {
  if (hello.protocol != kProtocolVersion) {
    road_.send(from,
               Refused{fmt::format("protocol {} is spoken here, not {}", kProtocolVersion, hello.protocol)});
    return;
  }
  if (workers_.size() > kMostRemembered)
    std::erase_if(workers_, [](const auto& w) { return !w.second.present; });
  const auto [known, fresh] = workers_.try_emplace(from);
  WorkerRecord& record = known->second;
  const bool came = fresh || !record.present;
  record.present = true;
  record.name = hello.name.empty() ? from : hello.name;
  record.device_class = hello.device_class;
  record.slots = hello.slots;
  if (came)
    spdlog::info("coordinator: worker {} joined: {} slots, {}", record.name, record.slots,
                 record.device_class);
  for (auto& [id, active] : active_) active.offered.erase(from);
  road_.send(from, Welcome{kProtocolVersion, options_.heartbeat, options_.idle_heartbeat()});
  tell(Joined{from, hello.slots, hello.device_class, record.name}, now);
}

void Coordinator::leave(const WorkerId& from, Instant now) {
  if (const auto worker = workers_.find(from); worker != workers_.end() && worker->second.present) {
    worker->second.present = false;
    spdlog::info("coordinator: worker {} left", worker->second.name);
  }
  tell(Left{from}, now);
}

void Coordinator::answer(const WorkerId& from, const NeedJob& need, Instant now) {
  tell(Heard{from}, now);
  const auto check = std::ranges::find(checks_, need.id, [](const auto& c) { return c.second.job; });
  if (const Active* active = active_of(need.id))
    road_.send(from, JobOffer{need.id, active->frame().job()});
  else if (check != checks_.end())
    road_.send(from, JobOffer{need.id, check->second.check.job});
  else
    road_.send(from, JobOver{need.id});
}

void Coordinator::answer(const WorkerId& from, Ask ask, const Identity& who, Instant now) {
  HeldQuestion question{from, std::move(ask), who, now + kHold};
  if (options_.may_wait && options_.may_wait(question.ask.question))
    held_.hold(std::move(question));
  else
    answer_at_once(question);
}

void Coordinator::answer_at_once(const HeldQuestion& q) {
  Reply reply = Denied{ExitCode::bad_usage, "nothing is answered here"};
  if (options_.answer) reply = options_.answer(q.ask.question, q.who);
  road_.send(q.from, Answer{q.ask.number, std::move(reply)});
}

void Coordinator::answer_held(Instant now) {
  for (const HeldQuestion& question : held_.due(now, options_.may_wait)) answer_at_once(question);
}

Coordinator::Active* Coordinator::active_of(JobId job) {
  const auto found = active_.find(job);
  return found == active_.end() ? nullptr : &found->second;
}

bool Coordinator::fits(const RenderDone& result) const {
  if (const auto check = checks_.find(result.task); check != checks_.end())
    return result.block.sums.region() == check->second.check.work.region;
  const auto task = tasks_.find(result.task);
  if (task == tasks_.end()) return true;  // an old one: the scheduler drops it
  const auto* work = std::get_if<RenderTask>(&task->second.work);
  return work != nullptr && active_.at(task->second.job).frame().fits(*work, result.block);
}

bool Coordinator::fits(const FilterDone& result) const {
  const auto task = tasks_.find(result.task);
  if (task == tasks_.end()) return true;
  const auto* work = std::get_if<FilterTask>(&task->second.work);
  return work != nullptr && active_.at(task->second.job).frame().fits(*work, result.filtered);
}

template <class Result>
void Coordinator::take(const WorkerId& from, Result& result, Instant now) {
  if (!fits(result)) {
    TaskFailed message{result.task, result.attempt, "the answer does not fit the task", false};
    return failed(from, message, now);
  }
  in_hand_ = &result;
  in_hand_from_ = from;
  tell(Done{from, result.task, result.attempt, result.seconds}, now);
  in_hand_ = std::monostate{};
}

void Coordinator::failed(const WorkerId& from, TaskFailed& message, Instant now) {
  WorkerRecord stranger{.name = from};
  WorkerRecord& record = record_of(from, stranger);
  ++record.failed;
  ++counts_.failed;
  if (const auto task = tasks_.find(message.task); task != tasks_.end())
    note(active_.at(task->second.job), fmt::format("worker {} failed a task, attempt {}: {}", record.name,
                                                   message.attempt, message.reason));
  tell(Failed{from, message.task, message.attempt, message.reason, message.bad_input}, now);
}

WorkerRecord& Coordinator::record_of(const WorkerId& worker, WorkerRecord& stranger) {
  const auto known = workers_.find(worker);
  return known == workers_.end() ? stranger : known->second;
}

void Coordinator::note(const Active& active, const std::string& text) const {
  if (const auto& noted = runs_.at(active.shot).watcher.noted) noted(active.place, text);
}

// A filter task counts as much as it takes to render a few samples of its pixels.
Wish Coordinator::wish_of(const Active& active, TaskId id, const Work& work) const {
  constexpr double kFilterCost = 4;
  Wish wish{.task = id, .job = active.id};
  if (const auto* render = std::get_if<RenderTask>(&work)) {
    wish.scene = active.frame().job().scene.hash;
    wish.cost = static_cast<double>(render->region.area() * render->samples.count());
    return wish;
  }
  const Tile& tile = std::get<FilterTask>(work).tile;
  wish.filter = true;
  wish.cost = kFilterCost * static_cast<double>(tile.outer.area());
  wish.bytes = static_cast<std::uint64_t>(tile.outer.area()) * filter_shape(active.frame().job()).taken *
               sizeof(float);
  return wish;
}

void Coordinator::tell(const Event& event, Instant now) {
  for (const Command& command : scheduler_.handle(event, now))
    std::visit([&](const auto& c) { carry_out(c, now); }, command);
}

void Coordinator::carry_out(const AssignTask& c, Instant) {
  if (assign_check(c)) return;
  const auto found = tasks_.find(c.task);
  if (found == tasks_.end()) return;
  Active& active = active_.at(found->second.job);
  if (active.offered.insert(c.worker).second) road_.send(c.worker, JobOffer{active.id, active.frame().job()});
  Assign assign{found->second, c.attempt, {}};
  if (const auto* filter = std::get_if<FilterTask>(&assign.task.work)) {
    assign.input = active.frame().filter_input(*filter);
    const std::uint64_t bytes = bytes_of(assign.input);
    if (bytes > kMaxPixelBytes) {
      active.failure =
          "a tile and what its pixels touch of the frame before are more than a message holds (1 GiB):"
          " smaller tiles are needed";
      active.bad_input = true;
      return;
    }
    workers_[c.worker].bytes_out += bytes;
    counts_.bytes_out += bytes;
  }
  road_.send(c.worker, std::move(assign));
}

void Coordinator::carry_out(const RevokeTask& c, Instant) { road_.send(c.worker, Revoke{c.task, c.attempt}); }

void Coordinator::carry_out(const Accept& c, Instant now) {
  if (accept_check(c, now)) return;
  const auto node = tasks_.extract(c.task);
  if (node.empty()) return;
  Active& active = active_.at(node.mapped().job);
  WorkerRecord stranger;
  WorkerRecord& worker = record_of(in_hand_from_, stranger);
  active.state.device_classes.insert(worker.device_class);
  ++worker.done;
  Accepted accepted{.work = node.mapped().work,
                    .round = active.frame().round(),
                    .worker = in_hand_from_,
                    .device_class = worker.device_class};
  const auto keep = [&](double seconds, const Image& pixels) {
    worker.seconds += accepted.seconds = seconds;
    worker.bytes_in += pixels.data().size() * sizeof(float);
    counts_.bytes_in += pixels.data().size() * sizeof(float);
    if (Keeper* keeper = run_of(active).keeper) keeper->takes(active.place, std::move(accepted), pixels);
  };
  if (auto* render = std::get_if<RenderDone*>(&in_hand_)) {
    active.state.dropped += accepted.dropped = (*render)->dropped;
    counts_.pixel_samples +=
        static_cast<std::uint64_t>((*render)->block.sums.region().area() * (*render)->block.samples.count());
    keep((*render)->seconds, (*render)->block.sums);
    add(active, active.frame().fold(std::move((*render)->block)), now);
  } else if (auto* filter = std::get_if<FilterDone*>(&in_hand_)) {
    keep((*filter)->seconds, (*filter)->filtered);
    active.frame().stitch(std::get<FilterTask>(node.mapped().work), (*filter)->filtered);
  }
}

void Coordinator::carry_out(const GiveUp& c, Instant now) {
  if (give_up_check(c, now)) return;
  spdlog::error("coordinator: task {} failed for good: {}", c.task, c.reason);
  const auto found = tasks_.find(c.task);
  if (found == tasks_.end()) return;
  Active& active = active_.at(found->second.job);
  active.failure = c.reason;
  active.bad_input = c.bad_input;
}

void Coordinator::carry_out(const Forget& c, Instant) {
  WorkerRecord stranger{.name = c.worker};
  WorkerRecord& record = record_of(c.worker, stranger);
  record.present = false;
  const std::string text = fmt::format("worker {} fell silent; its tasks go to others", record.name);
  spdlog::warn("coordinator: {}", text);
  for (auto& [id, active] : active_)
    if (active.offered.erase(c.worker)) note(active, text);
}

void Coordinator::carry_out(const AskHello& c, Instant) { road_.send(c.worker, Unknown{}); }

void Coordinator::carry_out(const SetAside& c, Instant) {
  spdlog::error("coordinator: worker {} is set aside: {}", c.name, c.reason);
}

void Coordinator::carry_out(const ClassChanged& c, Instant) {
  const Active* active = active_of(c.job);
  if (!active || c.from.empty()) return;  // the first one is no change
  const std::string text =
      fmt::format("no worker of {} is left: tiles are filtered on {} from here on", c.from, c.to);
  spdlog::warn("coordinator: frame {}: {}", active->frame().job().frame, text);
  note(*active, text);
}

}  // namespace tessera
