// SPDX-License-Identifier: Apache-2.0
#include "worker/denoise/device_pool.h"

#include <gtest/gtest.h>

#include <vector>

namespace tessera {
namespace {

TEST(FirstDone, GivesEachDeviceItsShareBySpeed) {
  std::vector<DeviceLoad> devices{{0, 1.0}, {0, 0.25}};  // the second is four times as fast
  std::vector<int> tiles(2);
  for (int tile = 0; tile < 100; ++tile) {
    const std::size_t to = first_done(devices, 1);
    ++tiles[to];
    devices[to].work += 1;
  }
  EXPECT_EQ(tiles, (std::vector{20, 80}));
}

TEST(FirstDone, TriesOneThatWasNotMeasuredYet) {
  EXPECT_EQ(first_done(std::vector<DeviceLoad>{{1, 0.5}, {0, 0}}, 1), 1u);
  EXPECT_EQ(first_done(std::vector<DeviceLoad>{{0, 0}, {0, 0}}, 1), 0u);
}

TEST(FirstDone, WaitsForTheFastOneRatherThanGoToASlowOne) {
  EXPECT_EQ(first_done(std::vector<DeviceLoad>{{2, 0.1}, {0, 1.0}}, 1), 0u);
  EXPECT_EQ(first_done(std::vector<DeviceLoad>{{20, 0.1}, {0, 1.0}}, 1), 1u);
}

TEST(DevicePool, MeasuresWhatEachDeviceTakesAndForgetsWorkThatIsDone) {
  if (list_devices().empty()) GTEST_SKIP() << "no OpenCL device on this machine";
  DevicePool pool = DevicePool::open({"", ""});  // twice the same
  {
    DevicePool::Use first = pool.use(100), second = pool.use(100);
    EXPECT_NE(&first.device(), &second.device());
    EXPECT_EQ(pool.load(0).work, 100);
    first.done(50);
  }
  EXPECT_EQ(pool.load(0).work, 0);
  EXPECT_EQ(pool.load(1).work, 0);
  EXPECT_EQ(pool.load(0).seconds_per_work, 0.5);
  EXPECT_EQ(pool.load(1).seconds_per_work, 0);
}

}  // namespace
}  // namespace tessera
