// SPDX-License-Identifier: Apache-2.0
#include "cli/endpoint.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace tessera {
namespace {

TEST(Endpoint, IsWhatZeroMqCallsAHostAndAPort) {
  EXPECT_EQ(endpoint_of("--listen", "127.0.0.1:7711", true), "tcp://127.0.0.1:7711");
  EXPECT_EQ(endpoint_of("--listen", "farm.example", false), "tcp://farm.example:7711");
  EXPECT_EQ(endpoint_of("--listen", "tcp://farm:7000", false), "tcp://farm:7000");
  EXPECT_EQ(endpoint_of("--listen", "[::1]:9", false), "tcp://[::1]:9");
  EXPECT_EQ(endpoint_of("--listen", "127.0.0.1:0", true), "tcp://127.0.0.1:*");
  EXPECT_EQ(endpoint_of("--listen", "ipc:///tmp/farm", true), "ipc:///tmp/farm");
}

TEST(Endpoint, RefusesWhatIsNoneAndNamesTheOption) {
  for (const char* text :
       {"", ":7711", "host:", "host:x", "host:70000", "host:-1", "ho st:1", "[::1", "a/b:1"}) {
    try {
      endpoint_of("--coordinator", text, false);
      ADD_FAILURE() << text;
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ExitCode::bad_usage);
      EXPECT_THAT(e.what(), testing::HasSubstr("--coordinator"));
    }
  }
}

}  // namespace
}  // namespace tessera
