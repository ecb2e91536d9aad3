// SPDX-License-Identifier: Apache-2.0
// What is handed in to a farm as the bytes of a blob, and back. Bytes are untrusted: lengths and counts are
// checked before anything is allocated for them.
#pragma once

#include <string>
#include <string_view>

#include "core/submission.h"

namespace tessera {

inline constexpr std::size_t kMaxSubmissionBytes = std::size_t{1} << 26;

// Throws Error(bad_usage) if it takes more than kMaxSubmissionBytes. Precondition: validate() accepts it.
std::string encode(const Submission&);

// Throws ProtocolError that names the field, unless the bytes are a submission that validate() accepts.
Submission decode_submission(std::string_view bytes);

}  // namespace tessera
