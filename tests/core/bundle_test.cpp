// SPDX-License-Identifier: Apache-2.0
#include "core/bundle.h"

#include <gmock/gmock.h>

#include <random>

#include "core/error.h"

namespace tessera {
namespace {

using testing::HasSubstr;

Bundle sample() {
  return {"shots/a.json",
          {{"lib/tex 1.png", sha256("1"), 12},
           {"shots/a.json", sha256("2"), 0},
           {"shots/\xff.obj", sha256("3"), 1ull << 39}}};
}

std::string complaint(const Bundle& bundle) {
  try {
    validate(bundle);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

std::string complaint(std::string_view text) {
  try {
    parse_bundle(text);
  } catch (const InputError& error) {
    return error.what();
  }
  return "none";
}

Bundle of(const std::vector<std::string>& paths) {
  Bundle bundle{paths.front(), {}};
  for (const std::string& path : paths) bundle.files.push_back({path, sha256(path), 1});
  return bundle;
}

TEST(Bundle, ComesBackFromItsText) { EXPECT_EQ(parse_bundle(to_text(sample())), sample()); }

TEST(Bundle, ItsTextIsAsDocumented) {
  EXPECT_EQ(to_text({"a.json", {{"a.json", sha256(""), 0}}}),
            "tessera bundle 1\na.json\n"
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855 0 a.json\n");
}

TEST(Bundle, PathsStayBelowTheFolderTheyAreUnpackedIn) {
  for (const char* good : {"a", "a/b", "a b/c.d", "..a", "a..", "...", "caf\xc3\xa9", "-", "a\\b"})
    EXPECT_TRUE(is_bundle_path(good)) << good;
  for (const std::string& bad :
       {std::string(), std::string("/"), std::string("/a"), std::string("a/"), std::string("a//b"),
        std::string("."), std::string(".."), std::string("./a"), std::string("a/."), std::string("../a"),
        std::string("a/../b"), std::string("a/.."), std::string("a\nb"), std::string("a\0b", 3),
        std::string("\x7f"), std::string("a/") + std::string(256, 'x'), std::string(1025, 'a')})
    EXPECT_FALSE(is_bundle_path(bad)) << bad;
  std::string longest;
  while (longest.size() < 1022) longest += "a/";
  EXPECT_TRUE(is_bundle_path(longest + "ab"));
  EXPECT_FALSE(is_bundle_path(longest + "abc"));
}

TEST(Bundle, WhatCannotBeUnpackedIsRefused) {
  EXPECT_EQ(complaint(sample()), "none");
  EXPECT_THAT(complaint(of({"a", "a"})), HasSubstr("'a' is there twice or out of order"));
  EXPECT_THAT(complaint(of({"b", "a"})), HasSubstr("'a' is there twice or out of order"));
  EXPECT_THAT(complaint(of({"a", "a-b", "a/b"})), HasSubstr("'a' is a file and a folder"));
  EXPECT_THAT(complaint(of({"a/b", "a/b/c/d"})), HasSubstr("'a/b' is a file and a folder"));
  EXPECT_EQ(complaint(of({"a-b", "a/b", "ab"})), "none");
  EXPECT_THAT(complaint(of({"a", "b/../../c"})), HasSubstr("'b/../../c'"));
  Bundle bundle = sample();
  bundle.scene = "shots/b.json";
  EXPECT_THAT(complaint(bundle), HasSubstr("'shots/b.json' is not in it"));
  bundle = sample();
  bundle.files[0].digest = "../../../etc/passwd";
  EXPECT_THAT(complaint(bundle), HasSubstr("no digest"));
  bundle = sample();
  bundle.files[0].bytes = ~0ull;
  EXPECT_THAT(complaint(bundle), HasSubstr("too large"));
  bundle = sample();
  bundle.files[0].bytes = (1ull << 39) + 1;
  EXPECT_THAT(complaint(bundle), HasSubstr("too large"));
}

TEST(Bundle, ThereIsOneTextOfABundleOnly) {
  const std::string text = to_text(sample()), digest = sha256("1");
  EXPECT_EQ(complaint(text), "none");
  EXPECT_NE(complaint(text + "\n"), "none");
  EXPECT_NE(complaint(text.substr(0, text.size() - 1)), "none");
  EXPECT_NE(complaint("tessera bundle 2\na\n" + digest + " 1 a\n"), "none");
  EXPECT_EQ(complaint("tessera bundle 1\na\n" + digest + " 1 a\n"), "none");
  EXPECT_NE(complaint("tessera bundle 1\na\n" + digest + " 01 a\n"), "none");
  EXPECT_NE(complaint("tessera bundle 1\na\n" + digest + " -1 a\n"), "none");
  EXPECT_NE(complaint("tessera bundle 1\na\n" + digest + " 99999999999999999999999 a\n"), "none");
  EXPECT_NE(complaint("tessera bundle 1\na\n" + digest + "  a\n"), "none");
  EXPECT_NE(complaint("tessera bundle 1\na\n"), "none");
  EXPECT_NE(complaint(""), "none");
}

TEST(Bundle, TooManyFilesAreRefused) {
  std::string text = "tessera bundle 1\n000000\n";
  const std::string digest = sha256("");
  for (int i = 0; i <= 100'000; ++i) text += digest + " 0 " + std::to_string(1'000'000 + i) + "\n";
  EXPECT_THAT(complaint(text), HasSubstr("too many files"));
}

TEST(Bundle, DamagedTextIsABundleOrAnInputError) {
  const std::string whole = to_text(sample());
  std::mt19937 random{20261126};
  int refused = 0, read = 0;
  for (int i = 0; i < 20'000; ++i) {
    std::string text = whole;
    for (unsigned n = 1 + random() % 2; n > 0; --n)
      text[random() % text.size()] = static_cast<char>(random() % 4 == 0 ? random() : '0' + random() % 10);
    ++(complaint(text) == "none" ? read : refused);
  }
  EXPECT_GT(refused, 1000);
  EXPECT_GT(read, 1000);
}

}  // namespace
}  // namespace tessera
