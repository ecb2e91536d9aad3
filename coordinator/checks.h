// SPDX-License-Identifier: Apache-2.0
// Tasks that were accepted, done again by other workers to see whether the same bits come of them: what is
// asked for, and what came of it. Nothing of it enters an image.
#pragma once

#include <functional>
#include <optional>
#include <string>

#include "core/job.h"
#include "core/sha256.h"
#include "core/task.h"
#include "proto/message.h"

namespace tessera {

struct CheckResult {
  WorkerId worker;
  std::string name;                    // of the worker
  Digest digest;                       // of the pixels; empty if it failed
  std::optional<std::string> failure;  // why it could not be done
};

struct Check {
  Job job;
  RenderTask work;
  WorkerId avoid;            // who did it
  std::string device_class;  // only there are the same bits promised
  std::function<void(const CheckResult&)> told;
};

}  // namespace tessera
