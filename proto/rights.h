// SPDX-License-Identifier: Apache-2.0
// What each role may say. Whose job is whose is not known here: that is the coordinator's to check.
#pragma once

#include <optional>
#include <string>

#include "proto/message.h"
#include "proto/transport.h"

namespace tessera {

// Whether a coordinator hears this message from such a peer at all: questions from all, all else from
// workers.
bool may_say(const Identity&, const Message&);

// Why such a peer may not ask this, or nothing. Everybody may look; submitters and administrators upload,
// submit and control; administrators alone release workers.
std::optional<std::string> why_not(const Identity&, const Question&);

}  // namespace tessera
