// SPDX-License-Identifier: Apache-2.0
// The bytes are a packet of the farm: the first byte says how many floats of pixels stand at the end (0:
// there is no second part), between is the header. It is decoded, or refused with a ProtocolError; and what
// was decoded travels back and forth without a change.
#include <algorithm>
#include <array>
#include <cstdlib>

#include "proto/codec.h"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  const std::span all = std::as_bytes(std::span(data, size)).subspan(1);
  const std::size_t pixels = std::min<std::size_t>(data[0] * sizeof(float), all.size());
  const std::array parts{all.first(all.size() - pixels), all.last(pixels)};
  try {
    const tessera::Message message = tessera::decode(std::span(parts).first(data[0] > 0 ? 2 : 1));
    const tessera::Packet packet = tessera::encode(message);
    if (tessera::encode(tessera::decode(packet)).header != packet.header) std::abort();
  } catch (const tessera::ProtocolError&) {
  }
  return 0;
}
