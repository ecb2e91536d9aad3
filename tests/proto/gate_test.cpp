// SPDX-License-Identifier: Apache-2.0
#include "proto/gate.h"

#include <gtest/gtest.h>

#include "proto/keys.h"

namespace tessera {
namespace {

using std::chrono::seconds;

const std::string kRack(kKeyText, 'r'), kAda(kKeyText, 'a'), kMallory(kKeyText, 'm');
const std::string kList = "worker rack " + kRack + "\nsubmitter ada " + kAda + "\nworker mallory " + kMallory;
const Instant kStart{seconds{1000}};

struct Gates : testing::Test {
  Gate gate{{}, parse_allow_list(kList, "list")};
  std::variant<Admitted, Refusal> knock(const std::string& connection, const std::string& key,
                                        const std::string& id, Instant now = kStart, std::size_t bytes = 10) {
    return gate.admit({.connection = connection, .key = key, .id = id, .bytes = bytes}, now);
  }
  static Peer peer(const std::variant<Admitted, Refusal>& verdict) {
    return std::get<Admitted>(verdict).peer;
  }
};

TEST_F(Gates, AnIdIsGoodUnderItsKeysNameOnly) {
  EXPECT_EQ(peer(knock("1", kRack, "w")), "rack/w");
  EXPECT_EQ(peer(knock("2", kMallory, "w")), "mallory/w");
  EXPECT_EQ(gate.way_to("rack/w"), "1");
  EXPECT_EQ(gate.way_to("mallory/w"), "2");
  EXPECT_EQ(gate.way_to("w"), std::nullopt);
}

TEST_F(Gates, AnIdCannotPassForAnotherNamesPeer) {
  EXPECT_EQ(peer(knock("1", kRack, "w")), "rack/w");
  EXPECT_EQ(peer(knock("2", kMallory, "/rack/w")), "mallory//rack/w");
  EXPECT_EQ(gate.way_to("rack/w"), "1");
}

TEST_F(Gates, SaysWhyItRefuses) {
  EXPECT_EQ(std::get<Refusal>(knock("1", std::string(kKeyText, 'x'), "w")), Refusal::unknown_key);
  EXPECT_EQ(std::get<Refusal>(knock("1", "", "w")), Refusal::unknown_key);
  EXPECT_EQ(std::get<Refusal>(knock("1", kRack, "")), Refusal::bad_id);
  EXPECT_EQ(std::get<Refusal>(knock("1", kRack, std::string(65, 'w'))), Refusal::bad_id);
  EXPECT_EQ(std::get<Refusal>(knock("1", kAda, "w", kStart, kMaxHeaderBytes + 1)), Refusal::too_large);
  EXPECT_EQ(peer(knock("1", kRack, "w", kStart, kMaxHeaderBytes + 1)), "rack/w");
}

TEST_F(Gates, ARefusedCallerIsNotSpokenTo) {
  knock("1", kAda, "w", kStart, kMaxHeaderBytes + 1);
  EXPECT_EQ(gate.way_to("ada/w"), std::nullopt);
}

TEST_F(Gates, APeerIsSpokenToOverItsNewestConnectionWhateverComesLateOverTheOld) {
  knock("1", kRack, "w");
  knock("2", kRack, "w");
  EXPECT_EQ(gate.way_to("rack/w"), "2");
  knock("1", kRack, "w");
  EXPECT_EQ(gate.way_to("rack/w"), "2");
}

TEST_F(Gates, AWrongTurnIsMadeGoodWhenTheOtherConnectionHasBeenSilent) {
  knock("new", kRack, "w");
  knock("old", kRack, "w");  // read late, and for the first time
  EXPECT_EQ(gate.way_to("rack/w"), "old");
  knock("new", kRack, "w", kStart + seconds{2});
  EXPECT_EQ(gate.way_to("rack/w"), "new");
}

TEST_F(Gates, AKeyThatIsTakenOffTheListHasNoWay) {
  knock("1", kRack, "w");
  gate.allow(parse_allow_list("submitter ada " + kAda, "list"));
  EXPECT_EQ(gate.way_to("rack/w"), std::nullopt);
  EXPECT_EQ(std::get<Refusal>(knock("1", kRack, "w")), Refusal::unknown_key);
}

TEST_F(Gates, AKeyWithAnotherNameIsAnotherPeer) {
  knock("1", kRack, "w");
  gate.allow(parse_allow_list("worker barn " + kRack, "list"));
  EXPECT_EQ(peer(knock("1", kRack, "w")), "barn/w");
}

TEST(OpenGate, EverybodyIsLocal) {
  Gate gate({}, std::nullopt);
  const auto verdict = gate.admit({.connection = "1", .key = "", .id = "w", .bytes = 1 << 30}, kStart);
  EXPECT_EQ(std::get<Admitted>(verdict).peer, "w");
  EXPECT_EQ(std::get<Admitted>(verdict).who, Identity{});
  EXPECT_EQ(gate.way_to("w"), "1");
}

TEST(OpenGate, RemembersABoundedNumberOfPeers) {
  Gate gate({.connections = 100}, std::nullopt);
  for (int i = 0; i < 1000; ++i) {
    gate.admit({.connection = "faithful", .id = "faithful"}, kStart);
    const std::string name = std::to_string(i);
    gate.admit({.connection = name, .id = name}, kStart);
  }
  EXPECT_EQ(gate.way_to("faithful"), "faithful");
  EXPECT_EQ(gate.way_to("999"), "999");
  EXPECT_EQ(gate.way_to("0"), std::nullopt);
}

TEST(Recent, KeepsWhatIsUsedWithinHalfItsSize) {
  Recent<int> table(8);
  for (int i = 0; i < 100; ++i) {
    table.at("kept") = 7;
    table.at(std::to_string(i)) = i;
    EXPECT_LE(table.size(), 8u);
    for (int j = std::max(0, i - 2); j <= i; ++j) ASSERT_TRUE(table.find(std::to_string(j))) << i << ' ' << j;
  }
  ASSERT_TRUE(table.find("kept"));
  EXPECT_EQ(*table.find("kept"), 7);
  EXPECT_FALSE(table.find("50"));
}

TEST(RateMeter, TakesItsBurstAtOnceAndThenItsRate) {
  const RateLimit limit{
      .messages = 10, .bytes = 1e9, .message_burst = 5, .byte_burst = 1e9, .pause = Millis{0}};
  RateMeter meter;
  for (int i = 0; i < 5; ++i) EXPECT_TRUE(meter.admit(limit, 1, kStart));
  EXPECT_FALSE(meter.admit(limit, 1, kStart));
  EXPECT_FALSE(meter.admit(limit, 1, kStart + Millis{99}));
  EXPECT_TRUE(meter.admit(limit, 1, kStart + Millis{100}));
  EXPECT_FALSE(meter.admit(limit, 1, kStart + Millis{100}));
}

TEST(RateMeter, CountsBytes) {
  const RateLimit limit{
      .messages = 1e9, .bytes = 100, .message_burst = 1e9, .byte_burst = 1000, .pause = Millis{0}};
  RateMeter meter;
  EXPECT_TRUE(meter.admit(limit, 900, kStart));
  EXPECT_FALSE(meter.admit(limit, 101, kStart));
  EXPECT_TRUE(meter.admit(limit, 101, kStart + Millis{100}));
  EXPECT_FALSE(RateMeter().admit(limit, 1001, kStart));
}

TEST(RateMeter, IsDeafForItsPauseAfterTooMuch) {
  const RateLimit limit{.messages = 1000, .message_burst = 1, .pause = Millis{5000}};
  RateMeter meter;
  EXPECT_TRUE(meter.admit(limit, 1, kStart));
  EXPECT_FALSE(meter.admit(limit, 1, kStart));
  EXPECT_FALSE(meter.admit(limit, 1, kStart + Millis{4999}));
  EXPECT_TRUE(meter.admit(limit, 1, kStart + Millis{5000}));
}

}  // namespace
}  // namespace tessera
