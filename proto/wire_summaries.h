// SPDX-License-Identifier: Apache-2.0
// What is told of jobs, frames and workers, to Protobuf and back, with every size, count and number checked.
// Private to the codec. Sizes are such that an answer with kMaxListed of them fits into a message.
#pragma once

#include <string>
#include <string_view>

#include "core/job.h"
#include "proto/questions.h"
#include "proto/questions.pb.h"

namespace tessera {

inline constexpr std::size_t kMaxLine = 1024;                   // bytes of a text of which an answer has many
inline constexpr std::size_t kMaxErrors = 256;                  // of a frame
inline constexpr std::size_t kMaxCells = std::size_t{1} << 18;  // of all frames of an answer
inline constexpr int kMaxColumns = kMaxEdge / kCellEdge;        // of cells
inline constexpr int kMaxRounds = 1 << 20, kMaxTiles = 1 << 30;  // of a frame

// Cuts reasons to kMaxLine, and leaves out all errors but the latest kMaxErrors.
void to_wire(JobSummary&&, wire::JobSummary&);
void to_wire(WorkerSummary&&, wire::WorkerSummary&);
// Leaves out the cells, if there are more than `room`, which becomes what is left of it.
void to_wire(FrameSummary&&, wire::FrameSummary&, std::size_t& room);

// Throw ProtocolError.
JobSummary summary_from(const wire::JobSummary&);
FrameSummary summary_from(const wire::FrameSummary&);
WorkerSummary summary_from(const wire::WorkerSummary&);

std::string line(std::string text);  // cut to kMaxLine
std::int64_t time_from(std::int64_t ms, std::string_view field);

}  // namespace tessera
