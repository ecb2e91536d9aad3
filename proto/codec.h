// SPDX-License-Identifier: Apache-2.0
// Messages to bytes and back. Bytes are untrusted: every size, count and number is checked before anything is
// allocated for it. With wire_values, wire_questions and wire_answers, which belong to it, and
// submission_codec the only files that see Protobuf.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.h"
#include "proto/message.h"

namespace tessera {

// A message as it travels: one part, and a second one if there are pixels.
struct Packet {
  std::string header;  // serialised wire::Envelope
  Floats pixels;       // plane after plane, row-major; little-endian on the wire
  bool operator==(const Packet&) const = default;
};

// What a receiver accepts.
inline constexpr std::size_t kMaxHeaderBytes = 1 << 20;
inline constexpr int kMaxParts = 2;
inline constexpr int kMaxPlanes = 1024;                            // a film of every AOV has 576
inline constexpr std::size_t kMaxWorkerId = 64, kMaxKeyName = 32;  // characters
inline constexpr int kMaxSlots = 4096;
inline constexpr int kMaxHeld = 16384;         // entries of a heartbeat
inline constexpr std::size_t kMaxText = 4096;  // bytes of a path or a reason

// Bytes that are not a message. Says which field is wrong, and how.
class ProtocolError : public Error {
 public:
  ProtocolError(std::string_view field, std::string_view what)
      : Error(ExitCode::bad_input, "message: " + std::string(field) + ": " + std::string(what)) {}
};

// Pixels and pieces are moved, not copied. Reasons that are too long are cut. Precondition: the message is
// one that decode() accepts.
Packet encode(Message message);

// The bytes of a packet's second part.
std::span<const std::byte> bytes_of(const Floats& pixels);

// Throws ProtocolError unless `parts` are one whole valid message. Pixels are copied (they may lie at any
// address); their values are not looked at.
Message decode(std::span<const std::span<const std::byte>> parts);
Message decode(const Packet& packet);

// True if `id` may name a worker: 1 to 64 printable ASCII characters, no space.
bool is_worker_id(std::string_view id);

// True if a coordinator may call a peer so: by a worker's id, behind "NAME/" if it came with a key of that
// name.
bool is_peer(std::string_view peer);

}  // namespace tessera
