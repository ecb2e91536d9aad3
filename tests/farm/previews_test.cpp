// SPDX-License-Identifier: Apache-2.0
#include "coordinator/farm/previews.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace tessera {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

const Previews::Key kFrame{"job", 3};
Instant at(int ms) { return Instant{Millis(1'000'000 + ms)}; }

TEST(Previews, AreDueWhileSomebodyLooksAndEveryTwoSeconds) {
  Previews previews;
  EXPECT_THAT(previews.due(at(0)), IsEmpty());
  previews.asked(kFrame, at(0));
  EXPECT_THAT(previews.due(at(0)), ElementsAre(kFrame));
  ASSERT_TRUE(previews.begin(kFrame, {1}, at(0)));
  EXPECT_THAT(previews.due(at(2500)), IsEmpty()) << "one is being made";
  previews.made(kFrame, "a");
  EXPECT_THAT(previews.due(at(1999)), IsEmpty());
  EXPECT_THAT(previews.due(at(2000)), ElementsAre(kFrame));
  EXPECT_THAT(previews.due(at(10'001)), IsEmpty()) << "nobody looks any more";
  EXPECT_FALSE(previews.begin(kFrame, {1}, at(2000))) << "nothing changed";
  EXPECT_TRUE(previews.begin(kFrame, {2}, at(2000)));
}

TEST(Previews, ThatTakeLongAreMadeRarely) {
  Previews previews;
  previews.asked(kFrame, at(0));
  ASSERT_TRUE(previews.begin(kFrame, {1}, at(0)));
  previews.took(kFrame, Millis(50));
  previews.made(kFrame, "a");
  EXPECT_THAT(previews.due(at(4999)), IsEmpty());
  EXPECT_THAT(previews.due(at(5000)), ElementsAre(kFrame));
}

TEST(Previews, AreKeptUntilTheOneAfterTheNext) {
  Previews previews;
  previews.asked(kFrame, at(0));
  for (const char* png : {"a", "b", "c"}) previews.made(kFrame, png);
  EXPECT_EQ(previews.last(kFrame), sha256("c"));
  EXPECT_EQ(*previews.find(sha256("b")), "b");
  EXPECT_EQ(previews.find(sha256("a")), nullptr);
  previews.made(kFrame, "");  // it could not be made
  EXPECT_EQ(previews.last(kFrame), sha256("c"));
  previews.forget("job");
  EXPECT_EQ(previews.last(kFrame), "");
  EXPECT_EQ(previews.find(sha256("c")), nullptr);
  previews.made(kFrame, "d");  // too late
  EXPECT_EQ(previews.find(sha256("d")), nullptr);
}

}  // namespace
}  // namespace tessera
