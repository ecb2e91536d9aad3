// SPDX-License-Identifier: Apache-2.0
// A device for the tests of filters; tests are skipped where there is none.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>

#include "core/error.h"
#include "tests/worker/denoise/cases.h"
#include "tests/worker/denoise/inputs.h"
#include "worker/denoise/runner.h"

namespace tessera {

class OnDevice : public testing::Test {
 protected:
  void SetUp() override {
    const auto devices = list_devices();
    if (devices.empty()) GTEST_SKIP() << "OpenCL finds no device";
    const bool cpu = std::ranges::any_of(devices, [](const DeviceInfo& d) { return d.kind == "cpu"; });
    device_ = Device::open(cpu ? "" : "0");
  }

  // The picture alone: RGB.
  Image filtered(const FilterPlan& plan, const Image& input) {
    return planes_of(filtered_and_kept(plan, input), 0, 3);
  }
  // And behind it what is kept of it for the next frame.
  Image filtered_and_kept(const FilterPlan& plan, const Image& input, const Image& history = {}) {
    return filter(*device_, plan, input, {input.region(), input.region()}, input.region(), history);
  }
  // Every tile of `size` filtered with its halo, put together.
  Image stitched(const FilterPlan& plan, const Image& input, Size size) {
    Image whole(input.region(), 3 + plan.history());
    for (const Tile& tile : tiles_over(input.region(), size, plan.halo()))
      paste(whole, filter(*device_, plan, cropped(input, tile.outer), tile, input.region()));
    return planes_of(whole, 0, 3);
  }

  std::unique_ptr<Device> device_;
};

}  // namespace tessera
