// SPDX-License-Identifier: Apache-2.0
#include "core/exr_header.h"

#include <gtest/gtest.h>

#include <cstring>
#include <string>

namespace tessera {
namespace {

std::string number(std::int32_t v) {
  std::string bytes(sizeof v, '\0');
  std::memcpy(bytes.data(), &v, sizeof v);
  return bytes;
}

std::string attribute(const std::string& name, const std::string& type, const std::string& value) {
  return name + '\0' + type + '\0' + number(static_cast<std::int32_t>(value.size())) + value;
}

const std::string kStart("\x76\x2f\x31\x01\x02\0\0\0", 8), kEnd(1, '\0');
const std::string kChannel = std::string("R") + '\0' + std::string(16, '\0');

bool fits(const std::string& attributes) {
  const std::string file = kStart + attributes + kEnd;
  return exr_header_fits(file, file.size(), 0);
}

TEST(ExrHeader, OfValuesAsLongAsTheirTypesFits) {
  EXPECT_TRUE(fits(attribute("channels", "chlist", kChannel + kChannel + kEnd)));
  EXPECT_TRUE(fits(attribute("channels", "chlist", kEnd)));
  EXPECT_TRUE(fits(attribute("dataWindow", "box2i", std::string(16, '\0')) +
                   attribute("compression", "compression", "\1")));
  EXPECT_TRUE(fits(attribute("preview", "preview", number(2) + number(3) + std::string(24, 'p'))));
  EXPECT_TRUE(fits(attribute("owner", "string", "anybody") + attribute("ours", "unheard of", "12345")));
}

// Behind such a value OpenEXR takes the value's rest for the next attribute, and makes room for what it
// promises.
TEST(ExrHeader, OfAValueThatIsLongerOrShorterThanItsTypeDoesNotFit) {
  EXPECT_FALSE(fits(attribute("channels", "chlist", kChannel + kEnd + "more")));
  EXPECT_FALSE(fits(attribute("channels", "chlist", kChannel)));
  EXPECT_FALSE(fits(attribute("channels", "chlist", kChannel + "G")));
  EXPECT_FALSE(fits(attribute("compression", "compression", "\1more")));
  EXPECT_FALSE(fits(attribute("dataWindow", "box2i", std::string(15, '\0'))));
  EXPECT_FALSE(fits(attribute("preview", "preview", number(20000) + number(20000))));
  EXPECT_FALSE(fits(attribute("preview", "preview", number(-1) + number(-1) + "four")));
}

TEST(ExrHeader, WhoseAttributeIsLongerThanTheFileDoesNotFit) {
  EXPECT_FALSE(fits(std::string("ours") + '\0' + "opaque" + '\0' + number(1634231040)));
}

const std::string kManyParts("\x76\x2f\x31\x01\x02\x10\0\0", 8);
const std::string kOwner = attribute("owner", "string", "anybody");
const std::string kLie = std::string("ours") + '\0' + "opaque" + '\0' + number(1634231040);

ExrHeaders headers(const std::string& file) { return exr_headers(file, file.size(), 0); }

TEST(ExrHeader, EveryPartsIsLookedAt) {
  EXPECT_EQ(headers(kManyParts + kOwner + kEnd + kOwner + kEnd + kEnd + "pixels"), ExrHeaders::fit);
  EXPECT_EQ(headers(kManyParts + kOwner + kEnd + kOwner + kLie + kEnd + kEnd), ExrHeaders::lie);
  EXPECT_EQ(headers(kManyParts + kOwner + kEnd + attribute("owner", "float", "12345") + kEnd + kEnd),
            ExrHeaders::lie);
  EXPECT_EQ(headers(kManyParts + kOwner + kEnd + kOwner + kEnd), ExrHeaders::lie) << "they have no end";
  EXPECT_EQ(headers(kStart + kOwner + kEnd + kLie), ExrHeaders::fit) << "no header any more";
}

TEST(ExrHeader, SaysThatThereIsMoreOfIt) {
  const std::string file = kManyParts + kOwner + kEnd + kOwner + kEnd + kEnd;
  for (std::size_t n = kManyParts.size(); n < file.size(); ++n)
    EXPECT_EQ(exr_headers(file.substr(0, n), file.size(), 0), ExrHeaders::longer) << n;
}

TEST(ExrHeader, OfMorePartsThanAnImageMayHaveChannelsIsTooMany) {
  std::string parts = kManyParts;
  for (int i = 0; i < kMostExrParts; ++i) parts += kOwner + kEnd;
  EXPECT_EQ(headers(parts + kEnd), ExrHeaders::fit);
  EXPECT_EQ(headers(parts + kOwner + kEnd + kEnd), ExrHeaders::too_many);
}

}  // namespace
}  // namespace tessera
