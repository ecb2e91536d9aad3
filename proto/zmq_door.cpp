// SPDX-License-Identifier: Apache-2.0
#include "proto/zmq_door.h"

#include <fmt/format.h>

#include <cstring>
#include <vector>

#include "core/error.h"
#include "proto/keys.h"
#include "proto/zmq_socket.h"

namespace tessera {
namespace {

// Version, request, domain, address, routing id, mechanism, credentials.
enum Field : std::size_t { version, request, domain, address, routing_id, mechanism, credentials, kFields };
constexpr std::size_t kKeyBytes = 32;

// All parts of the next message, without waiting; empty if there is none.
std::vector<zmq::message_t> take_all(zmq::socket_t& socket) {
  std::vector<zmq::message_t> parts(1);
  if (!socket.recv(parts[0], zmq::recv_flags::dontwait)) return {};
  while (parts.back().more()) {
    zmq::message_t part;
    if (!socket.recv(part)) break;
    parts.push_back(std::move(part));
  }
  tell_sanitizer_of_handover(false);
  return parts;
}

std::string text_of(const std::vector<zmq::message_t>& parts, std::size_t field) {
  return field < parts.size() ? parts[field].to_string() : std::string();
}

// The key as text; empty if this is no request about one.
std::string key_of(const std::vector<zmq::message_t>& parts) {
  if (parts.size() != kFields || text_of(parts, mechanism) != "CURVE") return {};
  if (text_of(parts, domain) != kZapDomain || parts[credentials].size() != kKeyBytes) return {};
  char key[kKeyText + 1];
  return zmq_z85_encode(key, parts[credentials].data<std::uint8_t>(), kKeyBytes) ? key : "";
}

}  // namespace

ZmqDoor::ZmqDoor(zmq::context_t& context) : socket_(context, zmq::socket_type::rep) {
  socket_.set(zmq::sockopt::linger, 0);
  try {
    socket_.bind("inproc://zeromq.zap.01");
  } catch (const zmq::error_t& error) {
    throw Error(ExitCode::internal_error, fmt::format("cannot check keys: {}", error.what()));
  }
}

void ZmqDoor::answer(const std::function<bool(std::string_view)>& knows,
                     const std::function<void(std::string_view)>& refused) {
  for (;;) try {
      const std::vector<zmq::message_t> asked = take_all(socket_);
      if (asked.empty()) return;
      const std::string key = key_of(asked);
      const bool welcome = !key.empty() && knows(key);
      if (!welcome)
        refused(fmt::format("{}: its key {} is not on the allow-list", text_of(asked, address), key));
      const std::string answer[] = {"1.0",
                                    text_of(asked, request),
                                    welcome ? "200" : "400",
                                    welcome ? "" : "unknown key",
                                    welcome ? key : "",
                                    ""};
      for (const std::string& part : answer)
        socket_.send(zmq::buffer(part),
                     &part == &answer[5] ? zmq::send_flags::none : zmq::send_flags::sndmore);
    } catch (const zmq::error_t&) {
      return;  // a signal; what waits is answered the next time
    }
}

ZmqMonitor::ZmqMonitor(zmq::context_t& context, zmq::socket_t& watched)
    : watched_(watched), socket_(context, zmq::socket_type::pair) {
  const std::string name = fmt::format("inproc://handshakes-{}", static_cast<void*>(watched.handle()));
  const int events = ZMQ_EVENT_ACCEPTED | ZMQ_EVENT_HANDSHAKE_SUCCEEDED |
                     ZMQ_EVENT_HANDSHAKE_FAILED_NO_DETAIL | ZMQ_EVENT_HANDSHAKE_FAILED_PROTOCOL |
                     ZMQ_EVENT_HANDSHAKE_FAILED_AUTH;
  if (zmq_socket_monitor(watched.handle(), name.c_str(), events) != 0)
    throw Error(ExitCode::internal_error, fmt::format("cannot watch a socket: {}", zmq_strerror(errno)));
  socket_.set(zmq::sockopt::linger, 0);
  socket_.set(zmq::sockopt::rcvhwm, 0);  // ZeroMQ's own threads would wait for room
  socket_.connect(name);
}

ZmqMonitor::~ZmqMonitor() {
  // First: events for a monitor that is gone would hold up ZeroMQ's own threads.
  zmq_socket_monitor(watched_.handle(), nullptr, 0);
}

std::optional<Handshake> ZmqMonitor::next() {
  try {
    const std::vector<zmq::message_t> event = take_all(socket_);
    if (event.empty() || event[0].size() < 6) return std::nullopt;
    std::uint16_t what = 0;
    std::uint32_t detail = 0;
    std::memcpy(&what, event[0].data(), sizeof what);
    std::memcpy(&detail, event[0].data<char>() + sizeof what, sizeof detail);
    using End = Handshake::End;
    if (what == ZMQ_EVENT_ACCEPTED) return Handshake{End::accepted};
    if (what == ZMQ_EVENT_HANDSHAKE_SUCCEEDED) return Handshake{End::good};
    if (what == ZMQ_EVENT_HANDSHAKE_FAILED_AUTH) return Handshake{End::unknown_key};
    return Handshake{detail == ZMQ_PROTOCOL_ERROR_ZMTP_MECHANISM_MISMATCH ? End::no_agreement : End::broken};
  } catch (const zmq::error_t&) {
    return std::nullopt;
  }
}

}  // namespace tessera
