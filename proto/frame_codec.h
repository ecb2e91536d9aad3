// SPDX-License-Identifier: Apache-2.0
// What is kept of a frame, to bytes and back: a header, and the floats of its planes beside it, which may be
// more than Protobuf holds. Bytes come from a disk and are not trusted: everything is checked before anything
// is allocated. The only files that see Protobuf's store.proto.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

#include "core/image.h"
#include "proto/frame_log.h"

namespace tessera {

// All throw ProtocolError for bytes that are not what they ought to be. `plane_bytes`: of the floats that lie
// beside the header; others than it speaks of are refused.

// `pixels` is what the event brought; empty unless it is Accepted.
std::string header_of(const FrameEvent& event, const Image& pixels);
struct LoggedEvent {
  FrameEvent event;
  Image pixels;
};
// Without looking at its pixels.
FrameEvent event_of(std::string_view header);
// Its pixels are all 0: read into pixels.data().
LoggedEvent event_from(std::string_view header, std::uint64_t plane_bytes);

// Beside it: frame.sums, then frame.stitched.
std::string header_of(const Checkpoint&);
Checkpoint checkpoint_from(std::string_view header, std::uint64_t plane_bytes);

// Any image.
std::string header_of(const Image&);
Image image_from(std::string_view header, std::uint64_t plane_bytes);

}  // namespace tessera
