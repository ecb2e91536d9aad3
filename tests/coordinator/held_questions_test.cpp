// SPDX-License-Identifier: Apache-2.0
#include "coordinator/held_questions.h"

#include <gmock/gmock.h>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr Instant kBegin{};

std::vector<Peer> due(HeldQuestions& held, Instant now, bool may_wait) {
  std::vector<Peer> peers;
  for (const HeldQuestion& q : held.due(now, [&](const Question&) { return may_wait; }))
    peers.push_back(q.from);
  return peers;
}

HeldQuestion question(const Peer& from, Millis until, std::uint64_t number = 1) {
  return {from, Ask{number, ShowJob{"job"}}, {}, kBegin + until};
}

TEST(HeldQuestions, AreAnsweredWhenThereAreNewsForThem) {
  HeldQuestions held;
  held.hold(question("ada", Millis{400}));
  EXPECT_THAT(due(held, kBegin, false), IsEmpty());  // nobody says that anything has changed
  held.news();
  EXPECT_EQ(held.next(kBegin), kBegin);
  EXPECT_THAT(due(held, kBegin, true), IsEmpty());  // something else has
  EXPECT_EQ(held.next(kBegin), kBegin + Millis{400});
  held.news();
  EXPECT_THAT(due(held, kBegin, false), ElementsAre("ada"));
  EXPECT_EQ(held.next(kBegin), std::nullopt);
}

TEST(HeldQuestions, AreAnsweredWhenTheirTimeHasCome) {
  HeldQuestions held;
  held.hold(question("ada", Millis{400}));
  held.hold(question("bob", Millis{300}));
  EXPECT_EQ(held.next(kBegin), kBegin + Millis{300});
  EXPECT_THAT(due(held, kBegin + Millis{299}, true), IsEmpty());
  EXPECT_THAT(due(held, kBegin + Millis{300}, true), ElementsAre("bob"));
  EXPECT_THAT(due(held, kBegin + Millis{400}, true), ElementsAre("ada"));
}

TEST(HeldQuestions, AreOneForEachPeer) {
  HeldQuestions held;
  held.hold(question("ada", Millis{300}, 1));
  held.hold(question("ada", Millis{400}, 2));
  EXPECT_THAT(due(held, kBegin + Millis{300}, true), IsEmpty());
  const auto both = held.due(kBegin + Millis{400}, [](const Question&) { return true; });
  ASSERT_EQ(both.size(), 1u);
  EXPECT_EQ(both[0].ask.number, 2u);
}

}  // namespace
}  // namespace tessera
