// SPDX-License-Identifier: Apache-2.0
#include "bench/farm/crowd.h"

#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <deque>
#include <map>
#include <span>
#include <stdexcept>
#include <utility>
#include <zmq.hpp>

#include "core/plan.h"
#include "proto/clock.h"
#include "proto/codec.h"

namespace tessera {
namespace {

constexpr Millis kHeartbeat{1000}, kSilence{600'000};
constexpr int kHighWater = 100'000;

Instant after(Instant from, double seconds) {
  return from + std::chrono::duration_cast<Instant::duration>(std::chrono::duration<double>(seconds));
}

struct Member {
  CrowdMember how;
  std::string id;
  zmq::socket_t socket;
  struct InHand {
    Task task;
    Attempt attempt;
  };
  std::deque<InHand> queue = {};
  Instant due{}, heartbeat{}, word{};
  Millis idle_heartbeat = kHeartbeat;
  double share = 0;  // of an interval, at which it speaks: not all do at the same instant
};

class Life {
 public:
  Life(const std::vector<CrowdMember>& members, const std::string& endpoint) {
    context_.set(zmq::ctxopt::max_sockets, static_cast<int>(members.size()) + 1);
    const Instant now = clock_now();
    for (std::size_t i = 0; i < members.size(); ++i) {
      Member m{members[i], "member-" + std::to_string(i), zmq::socket_t(context_, zmq::socket_type::dealer)};
      m.socket.set(zmq::sockopt::sndhwm, kHighWater);
      m.socket.set(zmq::sockopt::rcvhwm, kHighWater);
      m.socket.set(zmq::sockopt::linger, 0);
      m.socket.connect(endpoint);
      m.share = static_cast<double>(i + 1) / static_cast<double>(members.size());
      m.heartbeat = after(now, m.share);
      m.word = now;
      say_hello(m);
      items_.push_back({m.socket.handle(), 0, ZMQ_POLLIN, 0});
      members_.push_back(std::move(m));
    }
  }

  [[noreturn]] void live() {
    for (;;) {
      wait();
      const Instant now = clock_now();
      for (std::size_t i = 0; i < members_.size(); ++i) {
        Member& m = members_[i];
        if (items_[i].revents != 0) read(m);
        while (!m.queue.empty() && m.how.speed > 0 && m.due <= now) finish(m);
        if (m.heartbeat <= now) say_what_is_held(m, now);
      }
    }
  }

 private:
  struct Shape {
    int planes = 0, filtered = 0;
  };

  void wait() {
    Instant until = clock_now() + kHeartbeat;
    for (const Member& m : members_) {
      until = std::min(until, m.heartbeat);
      if (!m.queue.empty()) until = std::min(until, m.due);
    }
    const auto left = std::chrono::ceil<Millis>(until - clock_now());
    zmq::poll(items_, std::max(Millis{0}, left));
  }

  static void say(Member& m, Message message) {
    Packet packet = encode(std::move(message));
    m.socket.send(zmq::buffer(m.id), zmq::send_flags::sndmore);
    const bool pixels = !packet.pixels.empty();
    m.socket.send(zmq::buffer(packet.header), pixels ? zmq::send_flags::sndmore : zmq::send_flags::none);
    if (pixels) m.socket.send(zmq::buffer(packet.pixels), zmq::send_flags::none);
  }

  static void say_hello(Member& m) {
    say(m, Hello{.version = "0", .device_class = "none", .slots = 1, .name = m.id});
  }

  static void say_what_is_held(Member& m, Instant now) {
    Heartbeat beat;
    for (const auto& in_hand : m.queue) beat.held.push_back({in_hand.task.id, in_hand.attempt});
    say(m, std::move(beat));
    if (now - m.word >= kSilence) say_hello(m);
    m.heartbeat = now + (m.queue.empty() ? m.idle_heartbeat : kHeartbeat);
  }

  void read(Member& m) {
    for (;;) {
      std::vector<zmq::message_t> parts(1);
      if (!m.socket.recv(parts[0], zmq::recv_flags::dontwait)) return;
      while (parts.back().more()) {
        parts.emplace_back();
        std::ignore = m.socket.recv(parts.back());
      }
      std::vector<std::span<const std::byte>> bytes;
      for (const auto& part : parts)
        bytes.emplace_back(static_cast<const std::byte*>(part.data()), part.size());
      hear(m, decode(bytes));
    }
  }

  void hear(Member& m, Message message) {
    m.word = clock_now();
    if (auto* assign = std::get_if<Assign>(&message)) {
      if (m.how.speed == 0) return answer(m, assign->task, assign->attempt, m.how.says);
      if (m.queue.empty()) m.heartbeat = std::min(m.heartbeat, m.word + kHeartbeat);
      m.queue.push_back({assign->task, assign->attempt});
      if (m.queue.size() == 1) m.due = after(clock_now(), cost_of(assign->task.work) / m.how.speed);
    } else if (const auto* revoke = std::get_if<Revoke>(&message)) {
      drop(m, *revoke);
    } else if (const auto* offer = std::get_if<JobOffer>(&message)) {
      shapes_[offer->id] = {FilmLayout(film_aovs(offer->job)).planes(), filtered_planes(offer->job.filter)};
    } else if (const auto* welcome = std::get_if<Welcome>(&message)) {
      m.idle_heartbeat = welcome->idle_heartbeat;
      m.heartbeat = after(m.word, m.share * std::chrono::duration<double>(welcome->idle_heartbeat).count());
    } else if (std::holds_alternative<Unknown>(message)) {
      say_hello(m);
    }
  }

  static void drop(Member& m, const Revoke& revoke) {
    const auto is_it = [&](const auto& in_hand) {
      return in_hand.task.id == revoke.task && in_hand.attempt == revoke.attempt;
    };
    const bool at_work = !m.queue.empty() && is_it(m.queue.front());
    std::erase_if(m.queue, is_it);
    if (at_work && !m.queue.empty())
      m.due = after(clock_now(), cost_of(m.queue.front().task.work) / m.how.speed);
  }

  void finish(Member& m) {
    const Member::InHand done = std::move(m.queue.front());
    m.queue.pop_front();
    answer(m, done.task, done.attempt, cost_of(done.task.work) / m.how.speed);
    if (!m.queue.empty()) m.due = after(m.due, cost_of(m.queue.front().task.work) / m.how.speed);
  }

  void answer(Member& m, const Task& task, Attempt attempt, double seconds) {
    const Shape shape = shapes_[task.job];
    if (const auto* render = std::get_if<RenderTask>(&task.work)) {
      Image sums(render->region, shape.planes, 1.0f);
      say(m, RenderDone{task.id, attempt, {render->samples, std::move(sums)}, seconds});
    } else {
      Image planes(std::get<FilterTask>(task.work).tile.inner, shape.filtered, 1.0f);
      say(m, FilterDone{task.id, attempt, std::move(planes), seconds});
    }
  }

  zmq::context_t context_;
  std::deque<Member> members_;
  std::vector<zmq::pollitem_t> items_;
  std::map<JobId, Shape> shapes_;
};

[[noreturn]] void live(const std::vector<CrowdMember>& members, int pipe) {
  std::string endpoint(256, 0);
  const ssize_t got = ::read(pipe, endpoint.data(), endpoint.size());
  if (got <= 0) _exit(0);
  endpoint.resize(static_cast<std::size_t>(got));
  rlimit files{};
  getrlimit(RLIMIT_NOFILE, &files);
  files.rlim_cur = files.rlim_max;
  setrlimit(RLIMIT_NOFILE, &files);
  try {
    Life(members, endpoint).live();
  } catch (const std::exception& e) {
    std::ignore = ::write(STDERR_FILENO, e.what(), std::char_traits<char>::length(e.what()));
  }
  _exit(1);
}

}  // namespace

double cost_of(const Work& work) {
  constexpr double kFilterCost = 4;
  if (const auto* render = std::get_if<RenderTask>(&work))
    return static_cast<double>(render->region.area()) * render->samples.count();
  return kFilterCost * static_cast<double>(std::get<FilterTask>(work).tile.outer.area());
}

Crowd::Crowd(const std::vector<CrowdMember>& members) {
  std::array<int, 2> ends{};
  if (::pipe(ends.data()) != 0) throw std::runtime_error("no pipe");
  process_ = ::fork();
  if (process_ < 0) throw std::runtime_error("no process");
  if (process_ == 0) {
    ::close(ends[1]);
    live(members, ends[0]);
  }
  ::close(ends[0]);
  pipe_ = ends[1];
}

Crowd::~Crowd() {
  ::close(pipe_);
  ::kill(process_, SIGTERM);
  ::waitpid(process_, nullptr, 0);
}

void Crowd::connect(const std::string& endpoint) {
  if (::write(pipe_, endpoint.data(), endpoint.size()) < 0) throw std::runtime_error("the crowd is gone");
}

}  // namespace tessera
