// SPDX-License-Identifier: Apache-2.0
#include "cli/log_options.h"

#include <gtest/gtest.h>
#include <spdlog/spdlog.h>

#include <nlohmann/json.hpp>

namespace tessera {
namespace {

class LogOptionsTest : public testing::Test {
 protected:
  std::shared_ptr<spdlog::logger> before_ = spdlog::default_logger();
  ~LogOptionsTest() override { spdlog::set_default_logger(before_); }

  static nlohmann::json line(const std::string& message) {
    set_up_log({.level = "info", .format = "json"});
    testing::internal::CaptureStderr();
    spdlog::info("{}", message);
    spdlog::default_logger()->flush();
    return nlohmann::json::parse(testing::internal::GetCapturedStderr());
  }
};

TEST_F(LogOptionsTest, JsonTellsTheComponentFromTheMessage) {
  const nlohmann::json said = line("coordinator: worker \"a\n\xff\" left: 2 slots");
  EXPECT_EQ(said["component"], "coordinator");
  EXPECT_EQ(said["message"], "worker \"a\n\xef\xbf\xbd\" left: 2 slots");
  EXPECT_EQ(said["level"], "info");
  EXPECT_EQ(said["time"].get<std::string>().size(), std::string("2026-01-02T03:04:05.678Z").size());
}

TEST_F(LogOptionsTest, JsonOfAMessageWithoutAComponentIsTheMessage) {
  for (const std::string text : {"job 5: removed", "", ": x", "x", "x:y", "coordinator:"}) {
    const nlohmann::json said = line(text);
    EXPECT_FALSE(said.contains("component")) << text;
    EXPECT_EQ(said["message"], text);
  }
}

}  // namespace
}  // namespace tessera
