// SPDX-License-Identifier: Apache-2.0
// Answers what commands ask of a farm, as far as who asks may have it.
#pragma once

#include "coordinator/farm/farm.h"
#include "proto/questions.h"
#include "proto/transport.h"

namespace tessera {

// Never throws: what goes wrong is a Denied. Who may ask what at all is said in proto/rights.h; besides that,
// submitters change their own jobs only, and give priorities up to 50.
Reply answer(Farm& farm, const Question& question, const Identity& who);
// Nothing has happened since what the question says that was seen.
bool may_wait(const Farm& farm, const Question& question);

}  // namespace tessera
