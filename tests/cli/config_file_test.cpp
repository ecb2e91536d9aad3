// SPDX-License-Identifier: Apache-2.0
#include "cli/config_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::ThrowsMessage;

class ConfigFile : public testing::Test {
 protected:
  void SetUp() override {
    const char* name = testing::UnitTest::GetInstance()->current_test_info()->name();
    file_ = std::filesystem::path(testing::TempDir()) / (std::string("config-") + name + ".toml");
    for (const char* variable : {"TEST_THREADS", "TEST_DEVICE", "TEST_NAME"}) unsetenv(variable);
    app_.add_option("--threads", threads_)->envname("TEST_THREADS");
    app_.add_option("--device", devices_)->envname("TEST_DEVICE")->delimiter(',');
    app_.add_option("--name", name_)->envname("TEST_NAME");
    app_.add_option("--secret", name_);
  }
  void TearDown() override { std::filesystem::remove(file_); }

  void parse(const std::string& config, std::vector<std::string> words) {
    std::ofstream(file_) << config;
    read_config(file_, app_);
    std::ranges::reverse(words);
    app_.parse(words);
  }

  std::filesystem::path file_;
  CLI::App app_;
  int threads_ = 1;
  std::vector<std::string> devices_;
  std::string name_;
};

TEST_F(ConfigFile, SaysWhatTheCommandLineDoesNot) {
  parse("threads = 4\ndevice = [\"cpu\", \"gpu\"]\nname = \"rack 1\"\n", {});
  EXPECT_EQ(threads_, 4);
  EXPECT_EQ(devices_, (std::vector<std::string>{"cpu", "gpu"}));
  EXPECT_EQ(name_, "rack 1");
}

TEST_F(ConfigFile, GoesBehindTheEnvironmentWhichGoesBehindTheCommandLine) {
  setenv("TEST_THREADS", "5", 1);
  setenv("TEST_NAME", "environment", 1);
  parse("threads = 4\nname = \"file\"\n", {"--name", "words"});
  EXPECT_EQ(threads_, 5);
  EXPECT_EQ(name_, "words");
}

TEST_F(ConfigFile, RefusesWhatItDoesNotKnowAndNamesTheNearest) {
  EXPECT_THAT(
      [&] { parse("thread = 4\n", {}); },
      ThrowsMessage<InputError>(AllOf(HasSubstr(file_.string()), HasSubstr("did you mean 'threads'"))));
  EXPECT_THAT([&] { parse("secret = 4\n", {}); }, ThrowsMessage<InputError>(HasSubstr("secret")));
  EXPECT_THAT([&] { parse("[worker]\nthreads = 4\n", {}); }, ThrowsMessage<InputError>(HasSubstr("worker")));
  EXPECT_THAT([&] { read_config("/does/not/exist", app_); },
              ThrowsMessage<InputError>(HasSubstr("cannot be read")));
}

}  // namespace
}  // namespace tessera
