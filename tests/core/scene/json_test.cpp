// SPDX-License-Identifier: Apache-2.0
#include "core/scene/json.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/error.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

std::string refusal_of(const std::string& text) {
  try {
    parse_json(text, "f");
  } catch (const InputError& e) {
    return e.what();
  }
  return "parsed";
}

TEST(Json, HoldsWhatTheTextSaysInItsOrder) {
  const Json json = parse_json(R"({"b": [1, -2.5e3, true, null], "a": {"é": "x\n"}})", "f");
  EXPECT_EQ(json.members()[0].first, "b");
  EXPECT_EQ(json.members()[1].first, "a");
  const auto& items = json.find("b")->items();
  EXPECT_EQ(items[0].number(), 1);
  EXPECT_EQ(items[1].number(), -2500);
  EXPECT_TRUE(items[2].boolean());
  EXPECT_TRUE(items[3].is_null());
  EXPECT_EQ(json.find("a")->find("é")->text(), "x\n");
  EXPECT_EQ(json.find("c"), nullptr);
}

TEST(Json, ASyntaxErrorIsRefusedWithItsLineAndColumn) {
  EXPECT_THAT(refusal_of("{\n  \"a\": 1,\n  \"b\" 2\n}"), StartsWith("f:3:7: "));
  EXPECT_THAT(refusal_of(""), StartsWith("f:1:1: "));
  EXPECT_THAT(refusal_of("[1, 2"), StartsWith("f:1:"));
  EXPECT_THAT(refusal_of("{} x"), StartsWith("f:1:4: "));
  EXPECT_THAT(refusal_of("{} x"), HasSubstr("accepted: JSON"));
}

TEST(Json, NumbersThatAreNoNumbersAreRefused) {
  EXPECT_THAT(refusal_of("[NaN]"), StartsWith("f:1:2: "));
  EXPECT_THAT(refusal_of("[Infinity]"), StartsWith("f:1:2: "));
  EXPECT_THAT(refusal_of("[-Infinity]"), StartsWith("f:1:3: "));
  EXPECT_THAT(refusal_of("[1e999]"), StartsWith("f:1:"));
}

TEST(Json, AKeyThatIsThereTwiceIsRefused) {
  EXPECT_THAT(refusal_of(R"({"a": [0, {"x": 1, "x": 2}]})"),
              StartsWith("f:/a/1: the key 'x' is there twice"));
}

TEST(Json, NestingDeeperThanTheLimitIsRefused) {
  EXPECT_EQ(refusal_of(std::string(64, '[') + std::string(64, ']')), "parsed");
  EXPECT_THAT(refusal_of(std::string(65, '[') + std::string(65, ']')), HasSubstr("nested deeper than 64"));
  EXPECT_THAT(refusal_of(std::string(1'000'000, '[')), HasSubstr("nested deeper than 64"));
}

TEST(Json, PointersAreEscaped) { EXPECT_EQ(pointer_to(pointer_to("", "a/b~c"), 3), "/a~1b~0c/3"); }

}  // namespace
}  // namespace tessera
