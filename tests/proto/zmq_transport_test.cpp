// SPDX-License-Identifier: Apache-2.0
#include "proto/zmq_transport.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <cstdlib>
#include <filesystem>
#include <thread>
#include <zmq.hpp>

#include "proto/clock.h"
#include "tests/proto/samples.h"

namespace tessera {
namespace {

using std::chrono::hours;
using std::chrono::seconds;

std::string socket_file(const std::string& name) {
  const char* folder = std::getenv("TMPDIR");
  return "ipc://" + std::filesystem::path(folder ? folder : "/tmp").string() + "/tessera-" + name + "-" +
         std::to_string(getpid());
}

class OverEveryRoad : public testing::TestWithParam<std::string> {
 protected:
  std::string endpoint() const { return GetParam() == "ipc" ? socket_file("road") : GetParam(); }
  ZmqContext context;
  ZmqRouter router{context, {endpoint()}};
};
INSTANTIATE_TEST_SUITE_P(, OverEveryRoad, testing::Values("inproc://farm", "ipc", "tcp://127.0.0.1:*"),
                         [](const auto& road) { return road.param.substr(0, road.param.find(':')); });

// Says Hello until the router has heard it: a road may be under construction.
void meet(ZmqRouter& router, ZmqDealer& dealer) {
  for (;;) {
    dealer.send("coordinator", Goodbye{});
    if (router.receive(clock_now() + Millis{20})) break;
  }
  while (router.receive(clock_now() + Millis{20})) {
  }
}

// A port that was just closed is given back by ZeroMQ's own thread.
std::unique_ptr<ZmqRouter> listen_again(ZmqContext& context, const std::string& endpoint) {
  for (;;) try {
      return std::make_unique<ZmqRouter>(context, std::vector<std::string>{endpoint});
    } catch (const Error&) {
      std::this_thread::yield();
    }
}

TEST_P(OverEveryRoad, EveryMessageArrivesInBothDirectionsInOrder) {
  ZmqDealer dealer(context, router.endpoints()[0], "worker-1");
  meet(router, dealer);
  for (const Message& m : sample_messages()) dealer.send("coordinator", m);
  for (const Message& m : sample_messages()) {
    const auto mail = router.receive(clock_now() + seconds{10});
    ASSERT_TRUE(mail);
    EXPECT_EQ(mail->from, "worker-1");
    EXPECT_EQ(encode(mail->message), encode(m));
  }
  for (const Message& m : sample_messages()) router.send("worker-1", m);
  for (const Message& m : sample_messages()) {
    const auto mail = dealer.receive(clock_now() + seconds{10});
    ASSERT_TRUE(mail);
    EXPECT_EQ(mail->from, "coordinator");
    EXPECT_EQ(encode(mail->message), encode(m));
  }
}

TEST_P(OverEveryRoad, ManyMegabytesOfPixelsArrive) {
  ZmqDealer dealer(context, router.endpoints()[0], "worker-1");
  meet(router, dealer);
  const Image big = counting_image({0, 0, 512, 512}, 16);
  dealer.send("coordinator", RenderDone{1, 1, {{0, 8}, big}});
  const auto mail = router.receive(clock_now() + seconds{30});
  ASSERT_TRUE(mail);
  EXPECT_TRUE(same_bits(std::get<RenderDone>(mail->message).block.sums, big));
}

TEST_P(OverEveryRoad, AMessageToNobodyIsLost) {
  router.send("nobody", Unknown{});
  EXPECT_FALSE(router.receive(clock_now()));
}

TEST_P(OverEveryRoad, WakeEndsAReceiveThatWaits) {
  std::jthread waker([&] { router.wake(); });
  const Instant begin = clock_now();
  EXPECT_FALSE(router.receive(begin + hours{1}));
  EXPECT_LT(clock_now() - begin, seconds{60});
}

TEST_P(OverEveryRoad, AWakeThatCameBeforeIsNotLost) {
  router.wake();
  router.wake();
  EXPECT_FALSE(router.receive(clock_now() + hours{1}));
}

TEST_P(OverEveryRoad, MailThatIsNoMessageIsCountedAndDropped) {
  ZmqDealer dealer(context, router.endpoints()[0], "worker-1");
  meet(router, dealer);
  if (GetParam().starts_with("inproc")) return;  // a foreign context cannot reach it
  zmq::context_t foreign;
  zmq::socket_t rude(foreign, zmq::socket_type::dealer);
  rude.set(zmq::sockopt::linger, 10'000);
  rude.connect(router.endpoints()[0]);
  for (const std::string& noise : {std::string("noise"), std::string(1 << 20, 'x'), std::string()}) {
    rude.send(zmq::str_buffer("rude"), zmq::send_flags::sndmore);
    rude.send(zmq::buffer(noise), zmq::send_flags::none);
  }
  for (int part = 0; part < 100; ++part)
    rude.send(zmq::str_buffer("part"), part < 99 ? zmq::send_flags::sndmore : zmq::send_flags::none);
  zmq::socket_t nameless(foreign, zmq::socket_type::dealer);
  nameless.set(zmq::sockopt::linger, 10'000);
  nameless.connect(router.endpoints()[0]);
  const Packet hello = encode(Hello{1, "", "", 1});
  nameless.send(zmq::str_buffer(""), zmq::send_flags::sndmore);
  nameless.send(zmq::buffer(hello.header), zmq::send_flags::none);
  while (router.dropped() < 5) ASSERT_FALSE(router.receive(clock_now() + Millis{50}));
  dealer.send("coordinator", JobOver{7});
  const auto mail = router.receive(clock_now() + seconds{10});
  ASSERT_TRUE(mail);
  EXPECT_EQ(mail->from, "worker-1");
  EXPECT_EQ(router.dropped(), 5u);
  EXPECT_EQ(router.counts().alien, 4u);
  EXPECT_EQ(router.counts().bad_id, 1u);
}

TEST(ZmqRouter, ReportsWhyMailWasDropped) {
  ZmqContext context;
  std::vector<std::string> reasons;
  ZmqRouter router(context, {"tcp://127.0.0.1:*"},
                   {.on_dropped = [&](std::string_view why) { reasons.emplace_back(why); }});
  zmq::context_t foreign;
  zmq::socket_t rude(foreign, zmq::socket_type::dealer);
  rude.connect(router.endpoints()[0]);
  rude.send(zmq::str_buffer("rude"), zmq::send_flags::sndmore);
  rude.send(zmq::str_buffer("noise"), zmq::send_flags::none);
  while (reasons.empty()) router.receive(clock_now() + Millis{50});
  EXPECT_THAT(reasons, testing::ElementsAre(testing::HasSubstr("header")));
}

TEST(ZmqRouter, ListensOnSeveralEndpointsAtOnce) {
  ZmqContext context;
  ZmqRouter router(context, {"inproc://here", "tcp://127.0.0.1:*"});
  ZmqDealer near(context, router.endpoints()[0], "near"), far(context, router.endpoints()[1], "far");
  meet(router, near);
  meet(router, far);
}

TEST(ZmqRouter, SaysWhyItCannotListen) {
  ZmqContext context;
  const ZmqRouter first(context, {"tcp://127.0.0.1:*"});
  EXPECT_THAT([&] { ZmqRouter(context, {first.endpoints()[0]}); },
              testing::ThrowsMessage<Error>(testing::HasSubstr(first.endpoints()[0])));
  EXPECT_THROW(ZmqRouter(context, {"nonsense"}), Error);
}

TEST(ZmqRouter, ListensOnLoopbackOnly) {
  ZmqContext context;
  for (const char* open : {"tcp://*:*", "tcp://0.0.0.0:*", "tcp://eth0:7711", "tcp://127.evil.example:1"})
    EXPECT_THROW(ZmqRouter(context, {open}), Error) << open;
}

TEST(ZmqDealer, LosesWhatItSaysWhileNobodyListens) {
  ZmqContext context;
  const std::string endpoint = ZmqRouter(context, {"tcp://127.0.0.1:*"}).endpoints()[0];
  ZmqDealer dealer(context, endpoint, "early");
  for (int i = 0; i < 5000; ++i) dealer.send("coordinator", Hello{1, "", "", 1});
  EXPECT_FALSE(dealer.receive(clock_now()));
  const auto router = listen_again(context, endpoint);
  meet(*router, dealer);
}

TEST(ZmqDealer, FindsACoordinatorThatWasStartedAgain) {
  ZmqContext context;
  auto router = std::make_unique<ZmqRouter>(context, std::vector<std::string>{"tcp://127.0.0.1:*"});
  const std::string endpoint = router->endpoints()[0];
  ZmqDealer dealer(context, endpoint, "faithful");
  meet(*router, dealer);
  router.reset();
  const auto second = listen_again(context, endpoint);
  meet(*second, dealer);
}

}  // namespace
}  // namespace tessera
