// SPDX-License-Identifier: Apache-2.0
#include "proto/zmq_transport.h"

#include <fmt/format.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cassert>
#include <zmq.hpp>

#include "proto/clock.h"

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace tessera {

struct ZmqContext::Inside {
  explicit Inside(int io_threads) : context(io_threads) {}
  zmq::context_t context;
};

ZmqContext::ZmqContext(int io_threads) : inside_(std::make_unique<Inside>(io_threads)) {}
ZmqContext::~ZmqContext() = default;

namespace {

constexpr int kDeadConnection = 60'000;  // ms without a sign of life; longer than the largest part takes

bool is_loopback(std::string_view endpoint) {
  if (!endpoint.starts_with("tcp://")) return true;
  const std::string_view host = endpoint.substr(6, endpoint.rfind(':') - 6);
  return host == "localhost" || host == "[::1]" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == host.npos);
}

// ZeroMQ hands messages from thread to thread in ways that ThreadSanitizer does not see, so it is told.
void tell_sanitizer_of_handover([[maybe_unused]] bool giving) {
#if defined(__SANITIZE_THREAD__)
  static char road;
  giving ? __tsan_release(&road) : __tsan_acquire(&road);
#endif
}

// The floats themselves become the message; ZeroMQ frees them when they have left.
zmq::message_t part_of(std::vector<float>&& pixels) {
  auto owner = std::make_unique<std::vector<float>>(std::move(pixels));
  const auto release = [](void*, void* hint) {
    tell_sanitizer_of_handover(false);
    std::unique_ptr<std::vector<float>>(static_cast<std::vector<float>*>(hint));
  };
  void* data = owner->data();
  const std::size_t bytes = owner->size() * sizeof(float);
  return zmq::message_t(data, bytes, release, owner.release());
}

std::span<const std::byte> bytes_of(const zmq::message_t& part) {
  return {static_cast<const std::byte*>(part.data()), part.size()};
}

}  // namespace

class ZmqSocket {
 public:
  ZmqSocket(ZmqContext& context, zmq::socket_type type, ZmqOptions options)
      : socket_(context.inside().context, type),
        bell_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)),
        router_(type == zmq::socket_type::router),
        options_(std::move(options)) {
    if (bell_ < 0) throw Error(ExitCode::internal_error, "cannot open an eventfd");
    socket_.set(zmq::sockopt::sndhwm, options_.high_water);
    socket_.set(zmq::sockopt::rcvhwm, options_.high_water);
    socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(options_.max_part_bytes));
    socket_.set(zmq::sockopt::linger, router_ ? 0 : static_cast<int>(options_.linger.count()));
    socket_.set(zmq::sockopt::heartbeat_ivl, kDeadConnection / 4);
    socket_.set(zmq::sockopt::heartbeat_timeout, kDeadConnection);
  }
  ~ZmqSocket() { close(bell_); }
  ZmqSocket(const ZmqSocket&) = delete;
  ZmqSocket& operator=(const ZmqSocket&) = delete;

  zmq::socket_t& socket() { return socket_; }
  std::uint64_t dropped() const { return dropped_.load(std::memory_order_relaxed); }

  // `to` is the routing id a ROUTER puts in front.
  void send(const Peer* to, Message&& message) {
    Packet packet = encode(std::move(message));
    tell_sanitizer_of_handover(true);
    const auto more = zmq::send_flags::dontwait | zmq::send_flags::sndmore;
    const auto last = zmq::send_flags::dontwait;
    try {
      if (to && !socket_.send(zmq::buffer(*to), more)) return;
      const bool pixels = !packet.pixels.empty();
      if (!socket_.send(zmq::buffer(packet.header), pixels ? more : last)) return;
      if (!pixels) return;
      zmq::message_t part = part_of(std::move(packet.pixels));
      tell_sanitizer_of_handover(true);
      socket_.send(part, last);
    } catch (const zmq::error_t& error) {
      drop(fmt::format("not sent: {}", error.what()));
    }
  }

  std::optional<Mail> receive(Instant until) {
    for (;;) {
      if (auto mail = take()) return mail;
      if (!wait(until)) return std::nullopt;
    }
  }

  void wake() {
    const std::uint64_t one = 1;
    [[maybe_unused]] const ssize_t written = write(bell_, &one, sizeof one);  // full: it rings already
  }

 private:
  // The next whole message that is one, without waiting.
  std::optional<Mail> take() {
    for (;;) {
      std::vector<zmq::message_t> parts;
      std::size_t count = 0;
      if (!take_parts(parts, count)) return std::nullopt;
      if (auto mail = read(parts, count)) return mail;
    }
  }

  // Parts beyond those a message can have are counted and let go. False if there is nothing.
  bool take_parts(std::vector<zmq::message_t>& parts, std::size_t& count) {
    for (bool more = true; more; ++count) {
      zmq::message_t part;
      try {
        if (!socket_.recv(part, zmq::recv_flags::dontwait)) return false;
      } catch (const zmq::error_t&) {
        return false;
      }
      more = part.more();
      tell_sanitizer_of_handover(false);
      if (parts.size() < kMaxParts + 1u) parts.push_back(std::move(part));
    }
    return true;
  }

  std::optional<Mail> read(const std::vector<zmq::message_t>& parts, std::size_t count) {
    const std::size_t first = router_ ? 1 : 0;
    Mail mail{.from = "coordinator", .message = {}};
    if (router_) mail.from = parts[0].to_string();
    try {
      if (router_ && !is_worker_id(mail.from)) throw ProtocolError("sender", "is not a worker's id");
      if (count - first > kMaxParts) throw ProtocolError("parts", "too many");
      std::vector<std::span<const std::byte>> bytes;
      for (std::size_t i = first; i < parts.size(); ++i) bytes.push_back(bytes_of(parts[i]));
      mail.message = decode(bytes);
      return mail;
    } catch (const ProtocolError& error) {
      drop(error.what());
    } catch (const std::bad_alloc&) {
      drop("no memory for its pixels");
    }
    return std::nullopt;
  }

  // False at `until`, or when the bell has rung.
  bool wait(Instant until) {
    const auto left = std::chrono::ceil<Millis>(until - clock_now());
    const long timeout = std::clamp<long>(left.count(), 0, 3'600'000);
    std::array<zmq_pollitem_t, 2> items{
        {{socket_.handle(), 0, ZMQ_POLLIN, 0}, {nullptr, bell_, ZMQ_POLLIN, 0}}};
    if (zmq_poll(items.data(), items.size(), timeout) < 0) return false;  // a signal is a reason to look
    if (items[0].revents != 0) return true;
    if (items[1].revents != 0) {
      std::uint64_t rings = 0;
      [[maybe_unused]] const ssize_t got = ::read(bell_, &rings, sizeof rings);
      return false;
    }
    return clock_now() < until;
  }

  void drop(std::string_view reason) {
    dropped_.fetch_add(1, std::memory_order_relaxed);
    if (options_.on_dropped) options_.on_dropped(reason);
  }

  zmq::socket_t socket_;
  int bell_;  // an eventfd: wake() may come from any thread, a socket may not
  bool router_;
  ZmqOptions options_;
  std::atomic<std::uint64_t> dropped_ = 0;
};

ZmqRouter::ZmqRouter(ZmqContext& context, const std::vector<std::string>& endpoints, ZmqOptions options)
    : socket_(std::make_unique<ZmqSocket>(context, zmq::socket_type::router, std::move(options))) {
  zmq::socket_t& socket = socket_->socket();
  // A worker that comes back before its old connection is known to be dead takes its place.
  socket.set(zmq::sockopt::router_handover, true);
  for (const std::string& endpoint : endpoints) {
    if (!is_loopback(endpoint))
      throw Error(ExitCode::bad_usage, endpoint + ": listens beyond this machine; accepted: tcp://127.0.0.1");
    try {
      socket.bind(endpoint);
    } catch (const zmq::error_t& error) {
      throw Error(ExitCode::unreachable, fmt::format("cannot listen on {}: {}", endpoint, error.what()));
    }
    endpoints_.push_back(socket.get(zmq::sockopt::last_endpoint));
  }
}

ZmqRouter::~ZmqRouter() = default;
void ZmqRouter::send(const Peer& to, Message message) { socket_->send(&to, std::move(message)); }
std::optional<Mail> ZmqRouter::receive(Instant until) { return socket_->receive(until); }
void ZmqRouter::wake() { socket_->wake(); }
std::uint64_t ZmqRouter::dropped() const { return socket_->dropped(); }

ZmqDealer::ZmqDealer(ZmqContext& context, const std::string& endpoint, const WorkerId& id, ZmqOptions options)
    : socket_(std::make_unique<ZmqSocket>(context, zmq::socket_type::dealer, std::move(options))) {
  assert(is_worker_id(id));
  zmq::socket_t& socket = socket_->socket();
  socket.set(zmq::sockopt::routing_id, id);
  // Nothing is kept for a coordinator that is not there: it would be stale when it comes.
  socket.set(zmq::sockopt::immediate, true);
  socket.set(zmq::sockopt::reconnect_ivl, 100);
  socket.set(zmq::sockopt::reconnect_ivl_max, 5000);
  try {
    socket.connect(endpoint);
  } catch (const zmq::error_t& error) {
    throw Error(ExitCode::bad_usage, fmt::format("cannot connect to {}: {}", endpoint, error.what()));
  }
}

ZmqDealer::~ZmqDealer() = default;
void ZmqDealer::send(const Peer&, Message message) { socket_->send(nullptr, std::move(message)); }
std::optional<Mail> ZmqDealer::receive(Instant until) { return socket_->receive(until); }
void ZmqDealer::wake() { socket_->wake(); }
std::uint64_t ZmqDealer::dropped() const { return socket_->dropped(); }

}  // namespace tessera
