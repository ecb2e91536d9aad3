// SPDX-License-Identifier: Apache-2.0
// What the coordinator makes of its mail, and how it carries out what the scheduler decides.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <type_traits>

#include "coordinator/coordinator.h"

namespace tessera {
namespace {

bool travels(const FilterInput& input) {
  return (input.film.data().size() + input.history.data().size()) * sizeof(float) <= kMaxPixelBytes;
}

}  // namespace

void Coordinator::hear(Mail mail, Instant now) {
  std::visit(
      [&](auto& message) {
        using Kind = std::decay_t<decltype(message)>;
        if constexpr (std::is_same_v<Kind, Hello>)
          welcome(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, Heartbeat>)
          tell(Heard{mail.from, message.held}, now);
        else if constexpr (std::is_same_v<Kind, NeedJob>)
          answer(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, RenderDone> || std::is_same_v<Kind, FilterDone>)
          take(mail.from, message, now);
        else if constexpr (std::is_same_v<Kind, TaskFailed>)
          tell(Failed{mail.from, message.task, message.attempt, message.reason, message.bad_input}, now);
        else if constexpr (std::is_same_v<Kind, Goodbye>)
          tell(Left{mail.from}, now);
        else
          spdlog::warn("coordinator: {} sent a message that only a coordinator sends", mail.from);
      },
      mail.message);
}

void Coordinator::welcome(const WorkerId& from, const Hello& hello, Instant now) {
  if (hello.protocol != kProtocolVersion) {
    road_.send(from,
               Refused{fmt::format("protocol {} is spoken here, not {}", kProtocolVersion, hello.protocol)});
    return;
  }
  device_classes_[from] = hello.device_class;
  for (auto& [id, active] : active_) active.offered.erase(from);
  road_.send(from, Welcome{kProtocolVersion, options_.heartbeat});
  tell(Joined{from, hello.slots, hello.device_class, hello.name}, now);
}

void Coordinator::answer(const WorkerId& from, const NeedJob& need, Instant now) {
  tell(Heard{from}, now);
  if (const Active* active = active_of(need.id))
    road_.send(from, JobOffer{need.id, active->frame.job()});
  else
    road_.send(from, JobOver{need.id});
}

Coordinator::Active* Coordinator::active_of(JobId job) {
  const auto found = active_.find(job);
  return found == active_.end() ? nullptr : &found->second;
}

bool Coordinator::fits(const RenderDone& result) const {
  const auto task = tasks_.find(result.task);
  if (task == tasks_.end()) return true;  // an old one: the scheduler drops it
  const auto* work = std::get_if<RenderTask>(&task->second.work);
  return work != nullptr && active_.at(task->second.job).frame.fits(*work, result.block);
}

bool Coordinator::fits(const FilterDone& result) const {
  const auto task = tasks_.find(result.task);
  if (task == tasks_.end()) return true;
  const auto* work = std::get_if<FilterTask>(&task->second.work);
  return work != nullptr && active_.at(task->second.job).frame.fits(*work, result.filtered);
}

template <class Result>
void Coordinator::take(const WorkerId& from, Result& result, Instant now) {
  if (!fits(result)) {
    tell(Failed{from, result.task, result.attempt, "the answer does not fit the task", false}, now);
    return;
  }
  in_hand_ = &result;
  in_hand_from_ = from;
  tell(Done{from, result.task, result.attempt, result.seconds}, now);
  in_hand_ = std::monostate{};
}

void Coordinator::tell(const Event& event, Instant now) {
  for (const Command& command : scheduler_.handle(event, now))
    std::visit([&](const auto& c) { carry_out(c, now); }, command);
}

void Coordinator::carry_out(const AssignTask& c, Instant) {
  const auto found = tasks_.find(c.task);
  if (found == tasks_.end()) return;
  Active& active = active_.at(found->second.job);
  if (active.offered.insert(c.worker).second) road_.send(c.worker, JobOffer{active.id, active.frame.job()});
  Assign assign{found->second, c.attempt, {}};
  if (const auto* filter = std::get_if<FilterTask>(&assign.task.work)) {
    assign.input = active.frame.filter_input(*filter);
    if (!travels(assign.input)) {
      active.failure =
          "a tile and what its pixels touch of the frame before are more than a message holds (1 GiB):"
          " smaller tiles are needed";
      active.bad_input = true;
      return;
    }
  }
  road_.send(c.worker, std::move(assign));
}

void Coordinator::carry_out(const RevokeTask& c, Instant) { road_.send(c.worker, Revoke{c.task, c.attempt}); }

void Coordinator::carry_out(const Accept& c, Instant now) {
  const auto node = tasks_.extract(c.task);
  if (node.empty()) return;
  Active& active = active_.at(node.mapped().job);
  active.device_classes.insert(device_classes_[in_hand_from_]);
  if (auto* render = std::get_if<RenderDone*>(&in_hand_)) {
    active.dropped += (*render)->dropped;
    add(active, active.frame.fold(std::move((*render)->block)), now);
  } else if (auto* filter = std::get_if<FilterDone*>(&in_hand_)) {
    active.frame.stitch(std::get<FilterTask>(node.mapped().work), (*filter)->filtered);
  }
}

void Coordinator::carry_out(const GiveUp& c, Instant) {
  spdlog::error("coordinator: task {} failed for good: {}", c.task, c.reason);
  const auto found = tasks_.find(c.task);
  if (found == tasks_.end()) return;
  Active& active = active_.at(found->second.job);
  active.failure = c.reason;
  active.bad_input = c.bad_input;
}

void Coordinator::carry_out(const Forget& c, Instant) {
  spdlog::warn("coordinator: worker {} fell silent; its tasks go to others", c.worker);
  for (auto& [id, active] : active_) active.offered.erase(c.worker);
}

void Coordinator::carry_out(const AskHello& c, Instant) { road_.send(c.worker, Unknown{}); }

void Coordinator::carry_out(const ClassChanged& c, Instant) {
  if (!c.from.empty())
    spdlog::warn("coordinator: job {} is filtered by {} now, not by {}", c.job, c.to, c.from);
}

void Coordinator::carry_out(const SetAside& c, Instant) {
  spdlog::error("coordinator: worker {} ({}) is set aside: {}", c.worker, c.name, c.reason);
}

}  // namespace tessera
