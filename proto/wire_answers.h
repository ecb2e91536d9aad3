// SPDX-License-Identifier: Apache-2.0
// Answers to Protobuf and back, with every size, count and number checked. Private to the codec.
//
// Whatever is told of jobs, frames, events and workers, an answer fits into a message: texts that are too
// long are cut, of errors the latest are kept, and frames whose cells have no room any more go without.
#pragma once

#include "proto/questions.h"
#include "proto/questions.pb.h"

namespace tessera {

// Precondition: at most kMaxListed entries.
void to_wire(Answer&&, wire::Answer&);
// Throws ProtocolError. Moves the bytes of a piece out of what it is given.
Answer answer_from(wire::Answer&);

}  // namespace tessera
