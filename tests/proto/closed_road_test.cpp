// SPDX-License-Identifier: Apache-2.0
// Roads with keys: who is let in, who is not, and what changes while they are open.
#include <gmock/gmock.h>

#include <zmq.hpp>

#include "tests/proto/closed_farm.h"

namespace tessera {
namespace {

using testing::HasSubstr;

const KeyPair kRack = make_key_pair(), kAda = make_key_pair(), kStranger = make_key_pair();

struct ClosedRoad : testing::Test {
  ClosedFarm farm{{{"worker rack", kRack}, {"submitter,administrator ada", kAda}}};
};

// Fails to get in until it says why, and is not heard.
void expect_refused(ClosedFarm& farm, ZmqDealer& dealer, const std::string& why) {
  EXPECT_TRUE(farm.until([&] {
    dealer.send("coordinator", Goodbye{});
    dealer.receive(clock_now());
    return !dealer.refusal().empty();
  }));
  EXPECT_THAT(dealer.refusal(), HasSubstr(why));
  EXPECT_TRUE(farm.mails.empty());
  EXPECT_EQ(farm.router.counts().received, 0u);
}

TEST_F(ClosedRoad, LetsInTheKeysOnItsListAndSaysWhoTheyAre) {
  const auto rack = farm.dealer(kRack, "worker-1"), ada = farm.dealer(kAda, "worker-1");
  ASSERT_TRUE(farm.says(*rack, 1));
  const Identity worker{.name = "rack", .worker = true, .submitter = false, .administrator = false};
  for (const Mail& mail : farm.mails) {
    EXPECT_EQ(mail.who, worker);
    EXPECT_EQ(mail.from, "rack/worker-1");
  }
  farm.mails.clear();
  ASSERT_TRUE(farm.until([&] {
    ada->send("coordinator", Ask{7, ListJobs{}});
    return !farm.mails.empty();
  }));
  const Identity person{.name = "ada", .worker = false, .submitter = true, .administrator = true};
  EXPECT_EQ(farm.mails.back().who, person);
  EXPECT_EQ(farm.mails.back().from, "ada/worker-1");
  EXPECT_EQ(farm.router.counts().refused_keys, 0u);
  EXPECT_EQ(farm.router.counts().refused_handshakes, 0u);
  EXPECT_EQ(farm.router.dropped(), 0u);
}

TEST_F(ClosedRoad, RefusesAKeyThatIsNotOnItsListAndTellsItsOwner) {
  const auto stranger = farm.dealer(kStranger);
  expect_refused(farm, *stranger, kStranger.public_key);
  EXPECT_TRUE(farm.until([&] { return farm.router.counts().refused_keys > 0; }));
  EXPECT_TRUE(farm.says(*farm.dealer(kRack), 1));
}

TEST_F(ClosedRoad, RefusesAKeyWhosePublicPartWasStolen) {
  ZmqDealer thief(farm.others, farm.endpoint(), "worker-1", {},
                  ClientKeys{{kRack.public_key, kStranger.secret_key}, {farm.server.public_key}});
  expect_refused(farm, thief, "broke off");
  EXPECT_TRUE(farm.until([&] { return farm.router.counts().refused_handshakes > 0; }));
  EXPECT_TRUE(farm.says(*farm.dealer(kRack), 1));
}

TEST_F(ClosedRoad, RefusesPeersWithoutKeys) {
  ZmqDealer open(farm.others, farm.endpoint(), "worker-1");
  expect_refused(farm, open, "keygen");
  EXPECT_TRUE(farm.until([&] { return farm.router.counts().refused_handshakes > 0; }));
  EXPECT_TRUE(farm.says(*farm.dealer(kRack), 1));
}

TEST_F(ClosedRoad, RefusesPasswords) {
  zmq::context_t foreign;
  zmq::socket_t plain(foreign, zmq::socket_type::dealer);
  plain.set(zmq::sockopt::linger, 0);
  plain.set(zmq::sockopt::plain_username, "rack");
  plain.set(zmq::sockopt::plain_password, "rack");
  plain.connect(farm.endpoint());
  EXPECT_TRUE(farm.until([&] { return farm.router.counts().refused_handshakes > 0; }));
  EXPECT_TRUE(farm.mails.empty());
}

TEST_F(ClosedRoad, APeerThatExpectsAnotherCoordinatorDoesNotSpeakToThisOne) {
  ZmqDealer lost(farm.others, farm.endpoint(), "worker-1", {},
                 ClientKeys{kRack, {make_key_pair().public_key}});
  expect_refused(farm, lost, "public key is not");
}

TEST(OpenRoad, APeerWithKeysDoesNotSpeakToACoordinatorWithout) {
  ZmqContext context;
  ZmqRouter router(context, {"tcp://127.0.0.1:*"});
  ZmqDealer dealer(context, router.endpoints()[0], "worker-1", {},
                   ClientKeys{kRack, {make_key_pair().public_key}});
  const Instant end = clock_now() + std::chrono::seconds{30};
  while (dealer.refusal().empty() && clock_now() < end) {
    dealer.send("coordinator", Goodbye{});
    dealer.receive(clock_now() + Millis{5});
    EXPECT_FALSE(router.receive(clock_now()));
  }
  EXPECT_THAT(dealer.refusal(), HasSubstr("started without keys"));
}

TEST(OpenRoad, EverybodyIsLocalAndMayDoAll) {
  ZmqContext context;
  ZmqRouter router(context, {"tcp://127.0.0.1:*"});
  ZmqDealer dealer(context, router.endpoints()[0], "worker-1");
  std::optional<Mail> mail;
  for (const Instant end = clock_now() + std::chrono::seconds{30}; !mail && clock_now() < end;) {
    dealer.send("coordinator", Goodbye{});
    mail = router.receive(clock_now() + Millis{5});
  }
  ASSERT_TRUE(mail);
  EXPECT_EQ(mail->who, Identity{});
  EXPECT_EQ(mail->from, "worker-1");
}

TEST(ClosedRoads, ListenBeyondThisMachineWhichOpenOnesDoNot) {
  ZmqContext context;
  const ServerKeys keys{make_key_pair(), allow({{"worker rack", kRack}})};
  EXPECT_NO_THROW(ZmqRouter(context, {"tcp://0.0.0.0:*"}, {}, keys));
  EXPECT_THAT([&] { ZmqRouter(context, {"tcp://0.0.0.0:*"}); },
              testing::ThrowsMessage<Error>(HasSubstr("tessera keygen")));
}

TEST(ClosedRoads, NothingIsSentToOtherMachinesInPlainText) {
  ZmqContext context;
  EXPECT_THAT([&] { ZmqDealer(context, "tcp://farm.example:7711", "worker-1"); },
              testing::ThrowsMessage<Error>(HasSubstr("tessera keygen")));
}

TEST(ClosedRoads, AWorkerInTheSameProcessNeedsNoKey) {
  ZmqContext context;
  ZmqRouter router(context, {"tcp://127.0.0.1:*", "inproc://near"}, {},
                   ServerKeys{make_key_pair(), allow({{"worker rack", kRack}})});
  ZmqDealer near(context, "inproc://near", "worker-1");
  near.send("coordinator", NeedJob{1});
  const auto mail = router.receive(clock_now() + std::chrono::seconds{30});
  ASSERT_TRUE(mail);
  EXPECT_EQ(mail->who, Identity{});
}

TEST_F(ClosedRoad, WhoIsNoWorkerIsNotHeardAsOne) {
  const auto ada = farm.dealer(kAda);
  EXPECT_TRUE(farm.until([&] {
    ada->send("coordinator", Hello{});
    return farm.router.counts().no_right > 0;
  }));
  EXPECT_TRUE(farm.mails.empty());
}

TEST_F(ClosedRoad, WhoIsNoWorkerMaySendNoPixels) {
  const auto ada = farm.dealer(kAda);
  EXPECT_TRUE(farm.until([&] {
    ada->send("coordinator", RenderDone{1, 1, {{0, 8}, Image({0, 0, 256, 256}, 5)}});
    return farm.router.counts().too_large > 0;
  }));
  EXPECT_TRUE(farm.mails.empty());
  EXPECT_EQ(farm.router.counts().alien, 0u);  // nobody looked at what was in it
}

TEST_F(ClosedRoad, TheSameIdUnderAnotherKeyIsAnotherPeer) {
  farm.reload({{"worker rack", kRack}, {"worker mallory", kStranger}});
  const auto rack = farm.dealer(kRack, "worker-1");
  ASSERT_TRUE(farm.says(*rack, 1));
  const auto mallory = farm.dealer(kStranger, "worker-1");
  ASSERT_TRUE(farm.says(*mallory, 2));
  EXPECT_EQ(farm.mails.front().from, "rack/worker-1");
  EXPECT_EQ(farm.mails.back().from, "mallory/worker-1");
  // What is for one comes to that one, and the other's next message is the one that is for it.
  farm.router.send("rack/worker-1", JobOver{10});
  farm.router.send("mallory/worker-1", JobOver{20});
  farm.hear();
  const auto to_rack = rack->receive(clock_now() + std::chrono::seconds{30});
  const auto to_mallory = mallory->receive(clock_now() + std::chrono::seconds{30});
  ASSERT_TRUE(to_rack && to_mallory);
  EXPECT_EQ(std::get<JobOver>(to_rack->message).id, 10u);
  EXPECT_EQ(std::get<JobOver>(to_mallory->message).id, 20u);
}

TEST_F(ClosedRoad, AWorkerThatComesBackUnderItsKeyIsTheSamePeer) {
  ASSERT_TRUE(farm.says(*farm.dealer(kRack, "worker-1"), 1));
  const auto again = farm.dealer(kRack, "worker-1");
  ASSERT_TRUE(farm.says(*again, 2));
  EXPECT_EQ(farm.mails.back().from, farm.mails.front().from);
  farm.router.send("rack/worker-1", JobOver{10});
  const auto mail = again->receive(clock_now() + std::chrono::seconds{30});
  ASSERT_TRUE(mail);
  EXPECT_EQ(std::get<JobOver>(mail->message).id, 10u);
}

TEST_F(ClosedRoad, AKeyThatIsTakenOffTheListIsNeitherHeardNorSpokenToFromThenOn) {
  const auto rack = farm.dealer(kRack), ada = farm.dealer(kAda);
  ASSERT_TRUE(farm.says(*rack, 1));
  farm.reload({{"submitter ada", kAda}});
  farm.mails.clear();
  farm.router.send("rack/worker-1", JobOver{1});
  ASSERT_TRUE(farm.until([&] {
    rack->send("coordinator", NeedJob{2});
    return farm.router.counts().unknown_key > 0;
  }));
  EXPECT_TRUE(farm.mails.empty());
  EXPECT_FALSE(rack->receive(clock_now() + Millis{20}));
  // Put back on it, it goes on over the connection it has.
  farm.reload({{"worker rack", kRack}});
  EXPECT_TRUE(farm.says(*rack, 3));
}

TEST_F(ClosedRoad, RolesChangeWithTheList) {
  const auto rack = farm.dealer(kRack);
  ASSERT_TRUE(farm.says(*rack, 1));
  EXPECT_FALSE(farm.mails.back().who.submitter);
  farm.reload({{"worker,submitter rack", kRack}});
  farm.mails.clear();
  ASSERT_TRUE(farm.says(*rack, 2));
  EXPECT_TRUE(farm.mails.back().who.submitter);
}

TEST_F(ClosedRoad, AKeyThatIsPutOnTheListLaterGetsInByItself) {
  const auto stranger = farm.dealer(kStranger);
  expect_refused(farm, *stranger, kStranger.public_key);
  farm.reload({{"worker new", kStranger}});
  EXPECT_TRUE(farm.says(*stranger, 1));
  EXPECT_EQ(stranger->refusal(), "");
}

TEST_F(ClosedRoad, AWorkersKeyIsChangedWithoutStartingItAgain) {
  const auto rack = farm.dealer(kRack);
  ASSERT_TRUE(farm.says(*rack, 1));
  farm.reload({{"worker rack", kRack}, {"worker rack", kStranger}});
  rack->reload({kStranger, {farm.server.public_key}});
  ASSERT_TRUE(farm.says(*rack, 2));
  farm.reload({{"worker rack", kStranger}});
  farm.mails.clear();
  ASSERT_TRUE(farm.says(*rack, 3));
  EXPECT_EQ(farm.mails.back().from, "rack/worker-1");
}

TEST_F(ClosedRoad, TheCoordinatorsKeyIsChangedWithoutStartingAnythingAgain) {
  const KeyPair fresh = make_key_pair();
  ZmqDealer told(farm.others, farm.endpoint(), "told", {},
                 ClientKeys{kRack, {farm.server.public_key, fresh.public_key}});
  const auto untold = farm.dealer(kRack, "untold");
  ASSERT_TRUE(farm.says(told, 1));
  ASSERT_TRUE(farm.says(*untold, 2));
  const auto before = farm.endpoint();
  farm.router.reload({fresh, allow({{"worker rack", kRack}})});
  farm.hear();
  ASSERT_TRUE(farm.says(told, 3));
  EXPECT_EQ(farm.endpoint(), before);
  // One that knows the old key only is out, until it is told.
  EXPECT_TRUE(farm.until([&] {
    untold->receive(clock_now());
    return !untold->refusal().empty();
  }));
  untold->reload({kRack, {fresh.public_key}});
  EXPECT_TRUE(farm.says(*untold, 4));
}

TEST(ClosedRoads, OneThatSendsTooFastIsNotHeardForAWhileAndOthersAre) {
  ZmqOptions options;
  options.limits.worker = {.messages = 0, .message_burst = 100, .pause = std::chrono::minutes{10}};
  ClosedFarm farm({{"worker rack", kRack}, {"worker flood", kStranger}}, std::move(options));
  const auto rack = farm.dealer(kRack), flood = farm.dealer(kStranger);
  ASSERT_TRUE(farm.says(*flood, 1));
  ASSERT_TRUE(farm.until([&] {
    flood->send("coordinator", NeedJob{1});
    return farm.router.counts().too_fast >= 10;
  }));
  EXPECT_LE(farm.router.counts().received, 100u);
  farm.mails.clear();
  ASSERT_TRUE(farm.says(*rack, 2));
  for (const Mail& mail : farm.mails) EXPECT_EQ(mail.who.name, "rack");
}

}  // namespace
}  // namespace tessera
