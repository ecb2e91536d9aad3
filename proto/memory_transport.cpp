// SPDX-License-Identifier: Apache-2.0
#include "proto/memory_transport.h"

#include <condition_variable>
#include <map>
#include <mutex>
#include <random>
#include <utility>

#include "proto/clock.h"
#include "proto/codec.h"

namespace tessera {
namespace {

struct Letter {
  Peer from;
  std::shared_ptr<const Packet> packet;  // shared with its repetitions
};

struct Mailbox {
  std::multimap<Instant, Letter> letters;  // by arrival
  bool woken = false;
  std::condition_variable bell;
};

}  // namespace

class MemoryRoad::State {
 public:
  State(const Weather& weather, std::function<Instant()> virtual_clock)
      : weather_(weather), virtual_clock_(std::move(virtual_clock)), random_(weather.seed) {}

  std::shared_ptr<Mailbox> open(const Peer& name) {
    const std::lock_guard lock(mutex_);
    return boxes_[name] = std::make_shared<Mailbox>();
  }

  void close(const Peer& name, const std::shared_ptr<Mailbox>& box) {
    const std::lock_guard lock(mutex_);
    const auto it = boxes_.find(name);
    if (it != boxes_.end() && it->second == box) boxes_.erase(it);
  }

  void send(const Peer& from, const Peer& to, Message&& message) {
    const auto packet = std::make_shared<const Packet>(encode(std::move(message)));
    const std::lock_guard lock(mutex_);
    ++counts_.sent;
    // Drawn for every message, so that what becomes of one does not depend on who is there.
    const bool lost = chance() < weather_.loss, twice = chance() < weather_.repeat;
    const Instant first = now() + delay(), second = now() + delay();
    const auto it = boxes_.find(to);
    if (lost || it == boxes_.end()) {
      ++counts_.lost;
      return;
    }
    it->second->letters.insert({first, {from, packet}});
    if (twice) {
      ++counts_.repeated;
      it->second->letters.insert({second, {from, packet}});
    }
    it->second->bell.notify_all();
  }

  std::optional<Mail> receive(Mailbox& box, Instant until) {
    std::unique_lock lock(mutex_);
    for (;;) {
      const auto first = box.letters.begin();
      if (first != box.letters.end() && first->first <= now()) {
        const Letter letter = std::move(first->second);
        box.letters.erase(first);
        if (auto mail = opened(letter)) return mail;
        continue;
      }
      if (std::exchange(box.woken, false) || virtual_clock_ || now() >= until) return std::nullopt;
      box.bell.wait_until(lock, first == box.letters.end() ? until : std::min(until, first->first));
    }
  }

  void wake(Mailbox& box) {
    const std::lock_guard lock(mutex_);
    box.woken = true;
    box.bell.notify_all();
  }

  std::optional<Instant> next_arrival() const {
    const std::lock_guard lock(mutex_);
    std::optional<Instant> next;
    for (const auto& [name, box] : boxes_)
      if (!box->letters.empty() && (!next || box->letters.begin()->first < *next))
        next = box->letters.begin()->first;
    return next;
  }

  Counts counts() const {
    const std::lock_guard lock(mutex_);
    return counts_;
  }

 private:
  Instant now() const { return virtual_clock_ ? virtual_clock_() : clock_now(); }
  double chance() { return static_cast<double>(random_() >> 11) * 0x1p-53; }
  Instant::duration delay() {
    const auto spread = static_cast<double>((weather_.delay_max - weather_.delay_min).count());
    return weather_.delay_min + Instant::duration(static_cast<std::int64_t>(spread * chance()));
  }
  std::optional<Mail> opened(const Letter& letter) {
    try {
      Mail mail{letter.from, decode(*letter.packet)};
      ++counts_.received;
      return mail;
    } catch (const ProtocolError&) {
      ++counts_.malformed;
      return std::nullopt;
    }
  }

  const Weather weather_;
  const std::function<Instant()> virtual_clock_;
  mutable std::mutex mutex_;  // guards all below
  std::mt19937_64 random_;
  std::map<Peer, std::shared_ptr<Mailbox>> boxes_;
  Counts counts_;
};

namespace {

class MemoryTransport : public Transport {
 public:
  MemoryTransport(std::shared_ptr<MemoryRoad::State> road, Peer name)
      : road_(std::move(road)), name_(std::move(name)), box_(road_->open(name_)) {}
  ~MemoryTransport() override { road_->close(name_, box_); }
  void send(const Peer& to, Message message) override { road_->send(name_, to, std::move(message)); }
  std::optional<Mail> receive(Instant until) override { return road_->receive(*box_, until); }
  void wake() override { road_->wake(*box_); }

 private:
  std::shared_ptr<MemoryRoad::State> road_;
  Peer name_;
  std::shared_ptr<Mailbox> box_;  // the road holds it too, until another takes this one's place
};

}  // namespace

MemoryRoad::MemoryRoad(const Weather& weather, std::function<Instant()> virtual_clock)
    : state_(std::make_shared<State>(weather, std::move(virtual_clock))) {}
MemoryRoad::~MemoryRoad() = default;

std::unique_ptr<Transport> MemoryRoad::join(const Peer& name) {
  return std::make_unique<MemoryTransport>(state_, name);
}

std::optional<Instant> MemoryRoad::next_arrival() const { return state_->next_arrival(); }
MemoryRoad::Counts MemoryRoad::counts() const { return state_->counts(); }

}  // namespace tessera
