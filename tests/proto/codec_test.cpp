// SPDX-License-Identifier: Apache-2.0
#include "proto/codec.h"

#include <gmock/gmock.h>

#include <array>
#include <bit>
#include <cstring>
#include <limits>
#include <random>
#include <set>

#include "tests/proto/samples.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

Message round_trip(const Message& message) { return decode(encode(message)); }

std::string complaint(const Packet& packet) {
  try {
    decode(packet);
  } catch (const ProtocolError& error) {
    return error.what();
  }
  return "none";
}
std::string complaint(const Message& message) { return complaint(encode(message)); }

TEST(Codec, TheSamplesAreOfEveryKind) {
  std::set<std::size_t> kinds;
  for (const Message& m : sample_messages()) kinds.insert(m.index());
  EXPECT_EQ(kinds.size(), std::variant_size_v<Message>);
}

// Equal bytes of equal kinds mean equal fields, as no field of a sample is at its default; what the fields
// become is tested below.
TEST(Codec, EveryMessageComesBackAsItWas) {
  for (const Message& m : sample_messages()) {
    const Packet packet = encode(m);
    const Message back = decode(packet);
    EXPECT_EQ(back.index(), m.index());
    EXPECT_EQ(encode(back), packet) << "kind " << m.index();
  }
}

TEST(Codec, EveryFieldOfAJobTravels) {
  const JobOffer offer = std::get<JobOffer>(round_trip(JobOffer{77, sample_job()}));
  EXPECT_EQ(offer.id, 77u);
  EXPECT_EQ(offer.job, sample_job());
  EXPECT_EQ(std::get<JobOffer>(round_trip(JobOffer{1, Job{}})).job, Job{});
  EXPECT_EQ(std::get<JobOffer>(round_trip(JobOffer{1, sample_given_job()})).job, sample_given_job());
}

TEST(Codec, EveryFieldOfATaskTravels) {
  const Region inner{64, 128, 67, 133}, outer{60, 120, 72, 140};
  const Task render{5, 77, RenderTask{inner, {0, 8}}}, filter{6, 77, FilterTask{{inner, outer}, 3}};
  const Assign a = std::get<Assign>(round_trip(Assign{render, 2, {}}));
  EXPECT_EQ(a.task, render);
  EXPECT_EQ(a.attempt, 2u);
  EXPECT_TRUE(a.input.film.empty());
  const Assign b = std::get<Assign>(round_trip(Assign{filter, 1, counting_image(outer, 4)}));
  EXPECT_EQ(b.task, filter);
  EXPECT_TRUE(same_bits(b.input.film, counting_image(outer, 4)));
}

TEST(Codec, AHistoryTravelsBehindTheFilm) {
  const Region inner{64, 128, 67, 133}, outer{60, 120, 72, 140}, seen{50, 121, 66, 141};
  const Assign sent{
      {6, 77, FilterTask{{inner, outer}, 3}}, 1, {counting_image(outer, 4), counting_image(seen, 6)}};
  const Assign a = std::get<Assign>(round_trip(Assign(sent)));
  EXPECT_TRUE(same_bits(a.input.film, counting_image(outer, 4)));
  EXPECT_TRUE(same_bits(a.input.history, counting_image(seen, 6)));
  Packet packet = encode(Assign(sent));
  packet.pixels.pop_back();
  EXPECT_THAT(complaint(packet), StartsWith("message: input")) << "what is left for the film is too little";
  packet.pixels.resize(100);
  EXPECT_THAT(complaint(packet), StartsWith("message: history"));
  packet.pixels.clear();
  EXPECT_THAT(complaint(packet), StartsWith("message: input"));
}

TEST(Codec, EveryFieldOfAnAnswerTravels) {
  const Region region{64, 128, 67, 133};
  const auto r =
      std::get<RenderDone>(round_trip(RenderDone{7, 3, {{16, 32}, counting_image(region, 5)}, 1.5, 9}));
  EXPECT_EQ(std::tuple(r.task, r.attempt, r.block.samples, r.seconds, r.dropped),
            std::tuple(7u, 3u, SampleRange{16, 32}, 1.5, 9u));
  EXPECT_TRUE(same_bits(r.block.sums, counting_image(region, 5)));
  const auto f = std::get<FilterDone>(round_trip(FilterDone{8, 2, counting_image(region, 9), 0.25}));
  EXPECT_EQ(std::tuple(f.task, f.attempt, f.seconds), std::tuple(8u, 2u, 0.25));
  EXPECT_TRUE(same_bits(f.filtered, counting_image(region, 9)));
  const auto e = std::get<TaskFailed>(round_trip(TaskFailed{9, 1, "why", true}));
  EXPECT_EQ(std::tuple(e.task, e.attempt, e.reason, e.bad_input), std::tuple(9u, 1u, "why", true));
  const auto h = std::get<Hello>(round_trip(Hello{1, "0.1.0", "avx", 12}));
  EXPECT_EQ(std::tuple(h.protocol, h.version, h.device_class, h.slots), std::tuple(1, "0.1.0", "avx", 12));
  EXPECT_EQ(std::get<Heartbeat>(round_trip(Heartbeat{{{7, 1}, {9, 2}}})).held,
            (std::vector<Held>{{7, 1}, {9, 2}}));
  const auto welcome = std::get<Welcome>(round_trip(Welcome{1, Millis{250}, Millis{800}}));
  EXPECT_EQ(welcome.heartbeat, Millis{250});
  EXPECT_EQ(welcome.idle_heartbeat, Millis{800});
}

TEST(Codec, EveryBitOfAPixelTravelsNaNsAndNegativeZerosToo) {
  Image image({0, 0, 2, 2}, 1);
  image.at(0, 0, 0) = -0.0f;
  image.at(0, 1, 0) = std::bit_cast<float>(0x7fc12345u);
  image.at(0, 0, 1) = std::numeric_limits<float>::denorm_min();
  const Message m = round_trip(RenderDone{1, 1, {{0, 8}, image}});
  EXPECT_TRUE(same_bits(std::get<RenderDone>(m).block.sums, image));
}

TEST(Codec, AFilmOfEveryAovTravels) {
  const Message film =
      RenderDone{1, 1, {{0, 8}, counting_image({0, 0, 2, 1}, FilmLayout(AovSet::all()).planes())}};
  EXPECT_EQ(complaint(film), "none");
}

TEST(Codec, PixelsAreMovedIntoThePacketNotCopied) {
  Image image({0, 0, 64, 64}, 4);
  const float* where = image.data().data();
  EXPECT_EQ(encode(RenderDone{1, 1, {{0, 8}, std::move(image)}}).pixels.data(), where);
}

TEST(Codec, PixelsMayLieAtAnyAddress) {
  const Packet packet = encode(RenderDone{1, 1, {{0, 8}, counting_image({0, 0, 3, 3}, 2)}});
  std::vector<std::byte> shifted(packet.pixels.size() * 4 + 1);
  std::memcpy(shifted.data() + 1, packet.pixels.data(), shifted.size() - 1);
  const std::array parts{std::as_bytes(std::span(packet.header)),
                         std::span<const std::byte>(shifted).subspan(1)};
  EXPECT_TRUE(same_bits(std::get<RenderDone>(decode(parts)).block.sums, counting_image({0, 0, 3, 3}, 2)));
}

TEST(Codec, AReasonThatIsTooLongIsCutNotRefused) {
  const Message m = round_trip(TaskFailed{1, 1, std::string(100'000, 'x'), false});
  EXPECT_EQ(std::get<TaskFailed>(m).reason, std::string(kMaxText, 'x'));
}

TEST(Codec, AWrongNumberOfPartsIsRefused) {
  EXPECT_THAT([] { decode(std::span<const std::span<const std::byte>>{}); },
              testing::ThrowsMessage<ProtocolError>(HasSubstr("parts")));
  const Packet packet = encode(Goodbye{});
  const std::vector<std::span<const std::byte>> three(3, std::as_bytes(std::span(packet.header)));
  EXPECT_THROW(decode(three), ProtocolError);
  EXPECT_THAT(complaint(Packet{packet.header, {1.0f}}), StartsWith("message: pixels"));
  Packet stripped = encode(FilterDone{8, 2, counting_image({0, 0, 4, 4}, 9), 0});
  stripped.pixels.clear();
  EXPECT_THAT(complaint(stripped), StartsWith("message: filtered"));
}

TEST(Codec, PixelsOfTheWrongSizeAreRefused) {
  Packet packet = encode(RenderDone{1, 1, {{0, 8}, counting_image({0, 0, 4, 4}, 2)}});
  packet.pixels.push_back(0);
  EXPECT_THAT(complaint(packet), StartsWith("message: sums"));
  packet.pixels.resize(31);
  EXPECT_THAT(complaint(packet), StartsWith("message: sums"));
}

// Regions whose areas would need terabytes must be refused by comparing sizes, not by allocating.
TEST(Codec, AHugeRegionWithFewPixelsIsRefused) {
  const Packet big = encode(Assign{{1, 1, FilterTask{{{0, 0, 65536, 65536}, {0, 0, 65536, 65536}}, 0}},
                                   1,
                                   counting_image({0, 0, 1, 1}, 1)});
  EXPECT_THAT(complaint(big), StartsWith("message: input"));
}

TEST(Codec, NumbersOutOfRangeAreRefusedByTheNameOfTheirField) {
  const Image small({0, 0, 1, 1}, 1);
  const Image nine({0, 0, 1, 1}, 9);
  EXPECT_THAT(complaint(Hello{1, "", "", 0}), StartsWith("message: slots"));
  EXPECT_THAT(complaint(Hello{1, "", "", kMaxSlots + 1}), StartsWith("message: slots"));
  EXPECT_THAT(complaint(Hello{1, std::string(257, 'x'), "", 1}), StartsWith("message: version"));
  EXPECT_THAT(complaint(Welcome{1, Millis{0}}), StartsWith("message: heartbeat_ms"));
  EXPECT_THAT(complaint(Welcome{1, Millis{1ll << 62}}), StartsWith("message: heartbeat_ms"));
  EXPECT_THAT(complaint(Welcome{1, Millis{500}, Millis{499}}), StartsWith("message: idle_heartbeat_ms"));
  EXPECT_THAT(complaint(RenderDone{1, 1, {{0, 8}, small}, -1.0}), StartsWith("message: seconds"));
  EXPECT_THAT(complaint(FilterDone{1, 1, nine, std::numeric_limits<double>::quiet_NaN()}),
              StartsWith("message: seconds"));
  EXPECT_THAT(complaint(FilterDone{1, 1, small}), StartsWith("message: filtered"));
  for (const SampleRange bad : {SampleRange{0, 0}, {0, 7}, {8, 24}, {-8, 0}, {4, 12}, {0, 1 << 25}})
    EXPECT_THAT(complaint(RenderDone{1, 1, {bad, small}}), StartsWith("message: samples"));
  EXPECT_THAT(complaint(Heartbeat{std::vector<Held>(kMaxHeld + 1)}), StartsWith("message: held"));
}

TEST(Codec, RegionsOutsideTheLargestFrameAreRefused) {
  for (const Region bad : {Region{0, 0, 0, 5}, {5, 0, 4, 5}, {-1, 0, 4, 4}, {0, 0, 65537, 1}})
    EXPECT_THAT(complaint(Assign{{1, 1, RenderTask{bad, {0, 8}}}, 1, {}}), StartsWith("message: region"));
  EXPECT_THAT(
      complaint(Assign{{1, 1, FilterTask{{{0, 0, 8, 8}, {1, 0, 8, 8}}, 0}}, 1, Image({1, 0, 8, 8}, 1)}),
      StartsWith("message: outer"));
  EXPECT_THAT(
      complaint(Assign{{1, 1, FilterTask{{{0, 0, 8, 8}, {0, 0, 9, 8}}, 0}}, 1, Image({0, 0, 8, 8}, 1)}),
      StartsWith("message: input"));
}

TEST(Codec, AFrameThatIsGivenMayReachBeyondItsPictureButNotTooFar) {
  const auto task = [](const Region& r) {
    return Assign{{1, 1, FilterTask{{r, r}, 1}}, 1, Image({r.x0, r.y0, r.x0 + 1, r.y0 + 1}, 1)};
  };
  const Region beyond{-70'000, -3, -69'999, -2};
  EXPECT_EQ(complaint(task(beyond)), "none");
  EXPECT_EQ(complaint(FilterDone{1, 1, counting_image(beyond, 5)}), "none");
  for (const Region bad : {Region{-(1 << 30) - 1, 0, -(1 << 30), 1}, {0, (1 << 30) + 1, 1, (1 << 30) + 2}})
    EXPECT_THAT(complaint(task(bad)), StartsWith("message: inner"));
}

TEST(Codec, AJobThatIsNoneIsRefused) {
  const auto refused = [](auto&& spoil) {
    Job job = sample_job();
    spoil(job);
    return complaint(JobOffer{1, job});
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THAT(refused([](Job& j) { j.render.size.width = 0; }), HasSubstr("width"));
  EXPECT_THAT(refused([](Job& j) { j.render.size.height = 1 << 20; }), HasSubstr("height"));
  EXPECT_THAT(refused([](Job& j) { j.render.max_bounces = -1; }), HasSubstr("max_bounces"));
  EXPECT_THAT(refused([](Job& j) { j.render.aovs = AovSet::from_bits(std::uint64_t{1} << kAovs); }),
              HasSubstr("aovs"));
  EXPECT_THAT(refused([](Job& j) { j.crop = Region{0, 0, 700, 1}; }), HasSubstr("crop"));
  EXPECT_THAT(refused([&](Job& j) { j.acceptance.relmse = nan; }), HasSubstr("relmse"));
  EXPECT_THAT(refused([](Job& j) { j.acceptance.max_samples = 100; }), HasSubstr("max_samples"));
  EXPECT_THAT(refused([](Job& j) { j.task_samples = 0; }), HasSubstr("task_samples"));
  EXPECT_THAT(refused([](Job& j) { j.filter.name = "no such"; }), HasSubstr("filter"));
  EXPECT_THAT(refused([&](Job& j) { j.filter.parameters["x"] = nan; }), HasSubstr("filter"));
  EXPECT_THAT(refused([](Job& j) { j.scene.bundle = "../bundle"; }), HasSubstr("bundle"));
  EXPECT_THAT(refused([](Job& j) { j.scene.path = std::string(5000, 'x'); }), HasSubstr("path"));
}

TEST(Codec, AWorkersNameIsShortAndPrintable) {
  EXPECT_TRUE(is_worker_id("host-1.7f3a"));
  for (const std::string& bad : {std::string(), std::string("a b"), std::string("a\n"), std::string(1, '\0'),
                                 std::string("\xc3\xa9"), std::string(65, 'x')})
    EXPECT_FALSE(is_worker_id(bad)) << bad;
}

// Storms of damaged bytes: either a message or a ProtocolError, nothing else.
class DamagedBytes : public testing::Test {
 protected:
  std::mt19937 random{20240611};
  int messages = 0, refused = 0;

  void try_to_read(const std::vector<std::string>& parts) {
    std::vector<std::span<const std::byte>> bytes;
    for (const std::string& part : parts) bytes.push_back(std::as_bytes(std::span(part)));
    try {
      decode(bytes);
      ++messages;
    } catch (const ProtocolError&) {
      ++refused;
    }
  }

  static std::vector<std::string> parts_of(const Message& message) {
    const Packet packet = encode(message);
    std::vector<std::string> parts{packet.header};
    if (!packet.pixels.empty()) {
      const auto bytes = bytes_of(packet.pixels);
      parts.emplace_back(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    }
    return parts;
  }
};

TEST_F(DamagedBytes, EveryTruncationIsAMessageOrAProtocolError) {
  for (const Message& m : sample_messages()) {
    const std::vector<std::string> whole = parts_of(m);
    for (std::size_t p = 0; p < whole.size(); ++p)
      for (std::size_t n = 0; n < std::min<std::size_t>(whole[p].size(), 400); ++n) {
        std::vector<std::string> parts = whole;
        parts[p].resize(n);
        try_to_read(parts);
      }
  }
  EXPECT_GT(refused, 500);
}

TEST_F(DamagedBytes, EveryMutationIsAMessageOrAProtocolError) {
  std::vector<std::vector<std::string>> wholes;
  for (const Message& m : sample_messages()) wholes.push_back(parts_of(m));
  for (int i = 0; i < 40'000; ++i) {
    std::vector<std::string> parts = wholes[random() % wholes.size()];
    std::string& header = parts[0];
    for (unsigned n = 1 + random() % 4; n > 0; --n) {
      const std::size_t at = header.empty() ? 0 : random() % header.size();
      switch (random() % 4) {
        case 0:
          header.insert(at, 1, static_cast<char>(random()));
          break;
        case 1:
          if (!header.empty()) header.erase(at, 1);
          break;
        case 2:
          if (!header.empty()) header[at] = static_cast<char>(random());
          break;
        default:
          if (!header.empty()) header[at] ^= static_cast<char>(1u << (random() % 8));
          break;
      }
    }
    try_to_read(parts);
  }
  EXPECT_GT(refused, 10'000);
  EXPECT_GT(messages, 1'000);
}

TEST_F(DamagedBytes, NoiseIsAMessageOrAProtocolError) {
  for (int i = 0; i < 20'000; ++i) {
    std::vector<std::string> parts(1 + random() % 3);
    for (std::string& part : parts) {
      part.resize(random() % 64);
      for (char& c : part) c = static_cast<char>(random());
    }
    try_to_read(parts);
  }
  EXPECT_GT(refused, 10'000);
}

}  // namespace
}  // namespace tessera
