// SPDX-License-Identifier: Apache-2.0
// Answers what commands ask of a farm, as far as who asks may have it.
#pragma once

#include "coordinator/farm/farm.h"
#include "proto/questions.h"
#include "proto/transport.h"

namespace tessera {

// Never throws: what goes wrong is a Denied.
//
//   anybody with a key   blobs by their digests, lists and states
//   submitters           uploads and jobs; of their own jobs: cancel, pause, resume, verify, priorities up to
//   50 administrators       all of that, of any job; any priority; releases workers
Reply answer(Farm& farm, const Question& question, const Identity& who);

}  // namespace tessera
