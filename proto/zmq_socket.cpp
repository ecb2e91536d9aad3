// SPDX-License-Identifier: Apache-2.0
#include "proto/zmq_socket.h"

#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>

#include "proto/clock.h"

#if defined(__SANITIZE_THREAD__)
#include <sanitizer/tsan_interface.h>
#endif

namespace tessera {

ZmqContext::ZmqContext(int io_threads) : inside_(std::make_unique<Inside>(io_threads)) {}
ZmqContext::~ZmqContext() = default;

void tell_sanitizer_of_handover([[maybe_unused]] bool giving) {
#if defined(__SANITIZE_THREAD__)
  static char road;
  giving ? __tsan_release(&road) : __tsan_acquire(&road);
#endif
}

bool is_loopback(std::string_view endpoint) {
  if (!endpoint.starts_with("tcp://")) return true;
  const std::string_view host = endpoint.substr(6, endpoint.rfind(':') - 6);
  return host == "localhost" || host == "[::1]" ||
         (host.starts_with("127.") && host.find_first_not_of("0123456789.") == host.npos);
}

namespace {

// The floats themselves become the message; ZeroMQ frees them when they have left.
zmq::message_t part_of(Floats&& pixels) {
  auto owner = std::make_unique<Floats>(std::move(pixels));
  const auto release = [](void*, void* hint) {
    tell_sanitizer_of_handover(false);
    std::unique_ptr<Floats>(static_cast<Floats*>(hint));
  };
  void* data = owner->data();
  const std::size_t bytes = owner->size() * sizeof(float);
  return zmq::message_t(data, bytes, release, owner.release());
}

std::span<const std::byte> bytes_of(const zmq::message_t& part) {
  return {static_cast<const std::byte*>(part.data()), part.size()};
}

}  // namespace

ZmqSocket::ZmqSocket(ZmqContext& context, zmq::socket_type type, const ZmqOptions& options)
    : socket_(context.inside().context, type), bell_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (bell_ < 0) throw Error(ExitCode::internal_error, "cannot open an eventfd");
  const bool router = type == zmq::socket_type::router;
  socket_.set(zmq::sockopt::sndhwm, options.high_water);
  socket_.set(zmq::sockopt::rcvhwm, options.high_water);
  socket_.set(zmq::sockopt::maxmsgsize, static_cast<std::int64_t>(options.max_part_bytes));
  socket_.set(zmq::sockopt::linger, router ? 0 : static_cast<int>(options.linger.count()));
  look_for_life(router, options.dead);
}

// A router leaves it to its many peers to ask for a sign of life, and to its kernel to find those that are
// gone.
void ZmqSocket::look_for_life(bool router, Millis dead) {
  const int ms = static_cast<int>(dead.count()), seconds = std::max(4, ms / 1000);
  if (!router) {
    socket_.set(zmq::sockopt::heartbeat_ivl, ms / 2);
    socket_.set(zmq::sockopt::heartbeat_timeout, ms);
  }
  socket_.set(zmq::sockopt::tcp_keepalive, 1);
  socket_.set(zmq::sockopt::tcp_keepalive_idle, seconds / 2);
  socket_.set(zmq::sockopt::tcp_keepalive_intvl, seconds / 4);
  socket_.set(zmq::sockopt::tcp_keepalive_cnt, 2);
  socket_.set(zmq::sockopt::tcp_maxrt, ms);
}

ZmqSocket::~ZmqSocket() { close(bell_); }

std::optional<std::string> ZmqSocket::send(std::string_view front, Message&& message) {
  Packet packet = encode(std::move(message));
  tell_sanitizer_of_handover(true);
  const auto more = zmq::send_flags::dontwait | zmq::send_flags::sndmore;
  const auto last = zmq::send_flags::dontwait;
  try {
    if (!socket_.send(zmq::buffer(front), more)) return std::nullopt;
    const bool pixels = !packet.pixels.empty();
    if (!socket_.send(zmq::buffer(packet.header), pixels ? more : last)) return std::nullopt;
    if (!pixels) return std::nullopt;
    zmq::message_t part = part_of(std::move(packet.pixels));
    tell_sanitizer_of_handover(true);
    socket_.send(part, last);
  } catch (const zmq::error_t& error) {
    return std::string("not sent: ") + error.what();
  }
  return std::nullopt;
}

std::optional<ZmqSocket::Parts> ZmqSocket::take(std::size_t most) {
  Parts taken;
  for (bool more = true; more; ++taken.count) {
    zmq::message_t part;
    try {
      if (!socket_.recv(part, zmq::recv_flags::dontwait)) return std::nullopt;
    } catch (const zmq::error_t&) {
      return std::nullopt;
    }
    more = part.more();
    tell_sanitizer_of_handover(false);
    if (taken.parts.size() < most) taken.parts.push_back(std::move(part));
  }
  return taken;
}

bool ZmqSocket::wait(Instant until, std::span<zmq::socket_t* const> others) {
  const auto left = std::chrono::ceil<Millis>(until - clock_now());
  const long timeout = std::clamp<long>(left.count(), 0, 3'600'000);
  std::vector<zmq_pollitem_t> items{{nullptr, bell_, ZMQ_POLLIN, 0}, {socket_.handle(), 0, ZMQ_POLLIN, 0}};
  for (zmq::socket_t* other : others) items.push_back({other->handle(), 0, ZMQ_POLLIN, 0});
  if (zmq_poll(items.data(), static_cast<int>(items.size()), timeout) < 0) return false;  // a signal
  if (items[1].revents != 0) return true;
  if (items[0].revents != 0) {
    std::uint64_t rings = 0;
    [[maybe_unused]] const ssize_t got = ::read(bell_, &rings, sizeof rings);
    return false;
  }
  return clock_now() < until;
}

void ZmqSocket::ring() {
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(bell_, &one, sizeof one);  // full: it rings already
}

Message decode_parts(const ZmqSocket::Parts& taken, std::size_t skip) {
  if (taken.count > skip + kMaxParts) throw ProtocolError("parts", "too many");
  std::vector<std::span<const std::byte>> bytes;
  for (std::size_t i = skip; i < taken.parts.size(); ++i) bytes.push_back(bytes_of(taken.parts[i]));
  return decode(bytes);
}

}  // namespace tessera
