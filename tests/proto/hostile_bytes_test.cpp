// SPDX-License-Identifier: Apache-2.0
// Bytes from somebody who has no key, at the port of a coordinator that lets in none without: whatever they
// are, they are not heard as a message, the refusal is counted, and the farm goes on.
#include <gmock/gmock.h>

#include <random>

#include "tests/proto/closed_farm.h"
#include "tests/proto/wiretap.h"

namespace tessera {
namespace {

const KeyPair kRack = make_key_pair();

std::string greeting(const std::string& mechanism, bool server = false) {
  std::string g = std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x03\0", 12) + mechanism;
  g.resize(32);
  g += server ? '\x01' : '\0';
  g.resize(64);
  return g;
}

struct HostileBytes : testing::Test {
  ClosedFarm farm{{{"worker rack", kRack}}};

  // Says the bytes and no more, until the coordinator has hung up: it has counted it, and has not let it in.
  void refused(const std::string& bytes) {
    const RouterCounts before = farm.router.counts();
    TcpPeer peer(farm.port());
    peer.say(bytes);
    peer.end();
    bool closed = false;
    ASSERT_TRUE(farm.until([&] {
      peer.hear(0, closed);
      return closed;
    })) << "still open";
    ASSERT_TRUE(farm.until([&] { return farm.router.counts().connections > before.connections; }));
    ASSERT_EQ(farm.router.counts().let_in, before.let_in);
    ASSERT_TRUE(farm.mails.empty());
  }
  void serves_others() {
    EXPECT_TRUE(farm.mails.empty());
    EXPECT_EQ(farm.router.counts().received, 0u);
    EXPECT_TRUE(farm.says(*farm.dealer(kRack), 1));
  }
};

TEST_F(HostileBytes, NoiseIsRefused) {
  for (std::uint32_t seed = 0; seed < 100; ++seed) {
    std::mt19937 random(seed);
    std::string noise(1 + random() % 2000, '\0');
    for (char& c : noise) c = static_cast<char>(random());
    if (seed % 2 == 0) noise = greeting("CURVE") + noise;
    SCOPED_TRACE(seed);
    refused(noise);
    if (HasFatalFailure()) return;
  }
  serves_others();
}

TEST_F(HostileBytes, PlainTextOfEveryVersionOfTheProtocolIsRefused) {
  const std::string message = encode(Goodbye{}).header;
  const auto frame = [](char flags, const std::string& body) {
    return std::string{flags, static_cast<char>(body.size())} + body;
  };
  const auto old_frame = [](const std::string& body) {
    return std::string{static_cast<char>(body.size() + 1), '\0'} + body;
  };
  // 3.0: a greeting without a mechanism, READY, a message.
  refused(greeting("NULL") + frame(4, "\x05READY") + frame(1, "worker-1") + frame(0, message));
  refused(greeting("CURVE") + frame(4, "\x05READY") + frame(1, "worker-1") + frame(0, message));
  refused(greeting("CURVE") + frame(1, "worker-1") + frame(0, message));
  // 1.0 and 2.0: no mechanisms at all.
  refused(old_frame("") + old_frame("worker-1") + old_frame(message));
  refused(std::string("\xff\0\0\0\0\0\0\0\x01\x7f\x01\x05\0\0", 14) + frame(1, "worker-1") +
          frame(0, message));
  serves_others();
}

TEST_F(HostileBytes, FramesThatClaimToBeHugeAreRefused) {
  for (const char flags : {'\x02', '\x06'})
    for (const std::uint64_t size : {std::uint64_t{1} << 31, std::uint64_t{1} << 40, ~std::uint64_t{0}}) {
      std::string huge = greeting("CURVE") + flags;
      for (int shift = 56; shift >= 0; shift -= 8) huge += static_cast<char>(size >> shift);
      refused(huge + std::string(1000, 'x'));
    }
  serves_others();
}

// What a worker wrote, from its greeting to its first message. It says one only: none is on the road afterwards.
std::string conversation(ClosedFarm& farm) {
  Wiretap tap(farm.port());
  ZmqDealer dealer(farm.others, tap.endpoint(), "worker-1", {}, ClientKeys{kRack, {farm.server.public_key}});
  EXPECT_TRUE(farm.until([&] { return dealer.await(clock_now()); }));
  dealer.send("coordinator", NeedJob{1});
  EXPECT_TRUE(farm.until([&] { return !farm.mails.empty(); }));
  return tap.written_down();
}

TEST_F(HostileBytes, AConversationThatWasWrittenDownIsRefusedTheNextTimeWholeOrInPart) {
  const std::string written = conversation(farm);
  EXPECT_THAT(written, testing::Not(testing::HasSubstr("worker-1")));  // it is not in plain text
  ASSERT_GT(written.size(), 500u);
  const std::uint64_t heard = farm.router.counts().received;
  farm.mails.clear();
  refused(written);
  for (std::size_t bytes = 1; bytes < written.size() && !HasFatalFailure(); bytes += 23) {
    SCOPED_TRACE(bytes);
    refused(written.substr(0, bytes));
  }
  EXPECT_EQ(farm.router.counts().received, heard);
  EXPECT_TRUE(farm.says(*farm.dealer(kRack), 2));
}

TEST_F(HostileBytes, AConversationThatWasWrittenDownAndChangedIsRefused) {
  const std::string written = conversation(farm);
  const std::uint64_t heard = farm.router.counts().received;
  farm.mails.clear();
  for (std::size_t at = 0; at < written.size() && !HasFatalFailure(); at += 11) {
    SCOPED_TRACE(at);
    std::string changed = written;
    changed[at] = static_cast<char>(changed[at] ^ (1 << at % 8));
    refused(changed);
  }
  EXPECT_EQ(farm.router.counts().received, heard);
  EXPECT_TRUE(farm.says(*farm.dealer(kRack), 2));
}

TEST(Meddlers, WhatTheyChangeIsNotHeardAndTheWorkerComesBack) {
  // ZeroMQ counts the damage and stops listening to the connection; silence then ends it.
  const Millis dead{2000};
  ClosedFarm farm({{"worker rack", kRack}}, {.dead = dead});
  std::atomic<bool> meddle = false;
  Wiretap tap(farm.port(), [&](std::string& bytes, std::size_t) {
    if (!meddle || bytes.empty()) return;
    bytes.back() = static_cast<char>(bytes.back() ^ 1);
    meddle = false;
  });
  ZmqDealer dealer(farm.others, tap.endpoint(), "worker-1", {.dead = dead},
                   ClientKeys{kRack, {farm.server.public_key}});
  ASSERT_TRUE(farm.says(dealer, 1));
  farm.hear();
  farm.mails.clear();
  const RouterCounts before = farm.router.counts();
  meddle = true;
  dealer.send("coordinator", NeedJob{2});
  ASSERT_TRUE(
      farm.until([&] { return farm.router.counts().refused_handshakes > before.refused_handshakes; }));
  EXPECT_FALSE(meddle);
  EXPECT_TRUE(farm.says(dealer, 3));
  EXPECT_GT(farm.router.counts().connections, before.connections);
  for (const Mail& mail : farm.mails) EXPECT_NE(std::get<NeedJob>(mail.message).id, 2u);
}

TEST(LargeMessages, BeyondWhatACoordinatorTakesEndTheConnectionOfTheirSender) {
  ZmqOptions options;
  options.max_part_bytes = 1 << 20;
  ClosedFarm farm({{"worker rack", kRack}}, std::move(options));
  const auto large = farm.dealer(kRack, "large"), small = farm.dealer(kRack, "small");
  ASSERT_TRUE(farm.says(*large, 1));
  ASSERT_TRUE(farm.says(*small, 2));
  large->send("coordinator", RenderDone{1, 1, {{0, 8}, Image({0, 0, 1024, 1024}, 1)}});
  large->send("coordinator", NeedJob{3});
  farm.mails.clear();
  ASSERT_TRUE(farm.says(*small, 4));
  ASSERT_TRUE(farm.says(*large, 5));  // after it has connected again
  for (const Mail& mail : farm.mails) EXPECT_TRUE(std::holds_alternative<NeedJob>(mail.message));
}

}  // namespace
}  // namespace tessera
