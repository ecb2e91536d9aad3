// SPDX-License-Identifier: Apache-2.0
// The bytes are the header of something that a coordinator keeps of a frame: the first byte says of what (an event, a
// checkpoint, an image), the next two how many lines of 64 bytes of pixels lie beside it. It is read, or refused with a
// ProtocolError; and what was read travels back and forth without a change.
#include <cstdlib>
#include <string_view>

#include "proto/codec.h"
#include "proto/frame_codec.h"

namespace {

using namespace tessera;

constexpr std::uint64_t kLine = 64;

std::string written(const LoggedEvent& logged) { return header_of(logged.event, logged.pixels); }
std::string written(const Checkpoint& checkpoint) { return header_of(checkpoint); }
std::string written(const Image& image) { return header_of(image); }

template <class Read>
void check(Read&& read, std::string_view header) {
  const std::string again = written(read(header));
  if (written(read(again)) != again) std::abort();
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size < 3) return 0;
  const std::string_view header(reinterpret_cast<const char*>(data) + 3, size - 3);
  const std::uint64_t bytes = kLine * (data[1] + 256u * data[2]);
  try {
    switch (data[0] % 3) {
      case 0:
        check([&](std::string_view h) { return event_from(h, bytes); }, header);
        break;
      case 1:
        check([&](std::string_view h) { return checkpoint_from(h, bytes); }, header);
        break;
      default:
        check([&](std::string_view h) { return image_from(h, bytes); }, header);
    }
  } catch (const ProtocolError&) {
  }
  return 0;
}
