// SPDX-License-Identifier: Apache-2.0
#include "proto/frame_codec.h"

#include <gtest/gtest.h>

#include "proto/codec.h"
#include "tests/proto/samples.h"

namespace tessera {
namespace {

const Region kRegion{64, 128, 67, 133};
constexpr std::uint64_t kBytes = 3 * 5 * 4;  // of a plane

Accepted sample_result() {
  return {RenderTask{kRegion, {16, 32}}, 3, Digest(64, 'a'), "worker-1", "class", 1.5, 7};
}

Checkpoint sample_checkpoint() {
  Checkpoint c;
  c.frame.round = 2;
  c.frame.have = {16};
  c.frame.want = {32};
  c.frame.looks = {{16, {0.25, 0.125}, ErrorEstimate{0.5, 0.0625}, Guard::heavy_tails}};
  c.frame.states = {{CellStatus::exhausted, 16, 1, {0.25, 0.125}, Guard::too_dark}};
  c.frame.acceptable_share = 1;
  c.frame.sums = counting_image(kRegion, 5);
  c.frame.stitched = counting_image(kRegion, 9);
  c.device_classes = {"class"};
  c.errors = {0.5f};
  return c;
}

TEST(FrameCodec, GivesBackEvents) {
  const Image pixels = counting_image(kRegion, 5);
  const LoggedEvent logged = event_from(header_of(sample_result(), pixels), 5 * kBytes);
  EXPECT_EQ(std::get<Accepted>(logged.event), sample_result());
  EXPECT_EQ(logged.pixels.region(), kRegion);
  EXPECT_EQ(logged.pixels.planes(), 5);
  Accepted filter = sample_result();
  filter.work = FilterTask{{kRegion, grown(kRegion, 4)}, 3};
  EXPECT_EQ(std::get<Accepted>(event_of(header_of(filter, pixels))), filter);
  for (const Digest& history : {Digest(), Digest(64, '7')})
    EXPECT_EQ(std::get<Remembered>(event_of(header_of(Remembered{history}, {}))).history, history);
  EXPECT_EQ(std::get<Looked>(event_of(header_of(Looked{2.5}, {}))).seconds, 2.5);
}

TEST(FrameCodec, RefusesOtherPixelsThanTheHeaderSpeaksOf) {
  const std::string event = header_of(sample_result(), counting_image(kRegion, 5));
  const std::string checkpoint = header_of(sample_checkpoint());
  const std::string image = header_of(counting_image(kRegion, 5));
  EXPECT_NO_THROW(checkpoint_from(checkpoint, 14 * kBytes));
  EXPECT_NO_THROW(image_from(image, 5 * kBytes));
  for (const std::uint64_t bytes :
       {std::uint64_t{0}, 5 * kBytes - 1, 5 * kBytes + 4, std::uint64_t{1} << 63}) {
    EXPECT_THROW(event_from(event, bytes), ProtocolError);
    EXPECT_THROW(checkpoint_from(checkpoint, bytes), ProtocolError);
    EXPECT_THROW(image_from(image, bytes), ProtocolError);
  }
}

TEST(FrameCodec, RefusesNumbersThatCannotBe) {
  const auto refused = [](auto change) {
    Accepted result = sample_result();
    change(result);
    EXPECT_THROW(event_of(header_of(result, {})), ProtocolError);
  };
  refused([](Accepted& a) { a.round = 0; });
  refused([](Accepted& a) { a.digest = "abc"; });
  refused([](Accepted& a) { a.worker = "two words"; });
  refused([](Accepted& a) { a.device_class = std::string(1000, 'c'); });
  refused([](Accepted& a) { a.seconds = -1; });
  refused([](Accepted& a) { a.work = RenderTask{kRegion, {3, 7}}; });
  refused([](Accepted& a) { a.work = RenderTask{{5, 5, 5, 5}, {0, 8}}; });
  EXPECT_THROW(event_of(header_of(Remembered{"../x"}, {})), ProtocolError);
  EXPECT_THROW(event_of(header_of(Looked{-1}, {})), ProtocolError);
  EXPECT_THROW(event_of(""), ProtocolError);
  Checkpoint checkpoint = sample_checkpoint();
  checkpoint.frame.round = 0;
  EXPECT_THROW(checkpoint_from(header_of(checkpoint), 14 * kBytes), ProtocolError);
  checkpoint = sample_checkpoint();
  checkpoint.frame.states[0].status = static_cast<CellStatus>(9);
  EXPECT_THROW(checkpoint_from(header_of(checkpoint), 14 * kBytes), ProtocolError);
  checkpoint = sample_checkpoint();
  checkpoint.frame.want[0] = -8;
  EXPECT_THROW(checkpoint_from(header_of(checkpoint), 14 * kBytes), ProtocolError);
}

TEST(FrameCodec, DamagedHeadersAreRefusedOrAreWholeValues) {
  const Image pixels = counting_image(kRegion, 5);
  for (const std::string& header : {header_of(sample_result(), pixels), header_of(sample_checkpoint())})
    for (std::size_t at = 0; at < header.size(); ++at)
      for (int bit = 0; bit < 8; ++bit) {
        std::string damaged = header;
        damaged[at] ^= static_cast<char>(1 << bit);
        for (const std::uint64_t bytes : {5 * kBytes, 14 * kBytes}) {
          try {
            EXPECT_EQ(event_from(damaged, bytes).pixels.data().size_bytes(), bytes);
          } catch (const ProtocolError&) {
          }
          try {
            const FrameSnapshot frame = checkpoint_from(damaged, bytes).frame;
            EXPECT_EQ(frame.sums.data().size_bytes() + frame.stitched.data().size_bytes(), bytes);
          } catch (const ProtocolError&) {
          }
        }
      }
}

}  // namespace
}  // namespace tessera
