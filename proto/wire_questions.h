// SPDX-License-Identifier: Apache-2.0
// Questions to Protobuf and back, with every size, count and name checked. Private to the codec.
#pragma once

#include <string>
#include <string_view>

#include "proto/questions.h"
#include "proto/questions.pb.h"

namespace tessera {

inline constexpr int kMaxVerified = 1'000'000;  // tasks done again for one Control

void to_wire(Ask&&, wire::Ask&);
// Throws ProtocolError. Moves the bytes of a piece out of what it is given.
Ask ask_from(wire::Ask&);

// What questions and answers have in common.
Digest digest_from(const std::string&, std::string_view field);
JobName job_name_from(const std::string&);
// A piece of a blob lies within it.
void require_piece(const wire::Piece&);

}  // namespace tessera
