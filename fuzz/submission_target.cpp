// SPDX-License-Identifier: Apache-2.0
// The bytes are what is handed in to a farm: read, or refused with a ProtocolError; and what was read is
// written and read again without a change.
#include <cstdint>
#include <cstdlib>

#include "proto/codec.h"
#include "proto/submission_codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  try {
    const auto submission =
        tessera::decode_submission(std::string_view(reinterpret_cast<const char*>(data), size));
    if (tessera::decode_submission(tessera::encode(submission)) != submission) std::abort();
  } catch (const tessera::ProtocolError&) {
  }
  return 0;
}
