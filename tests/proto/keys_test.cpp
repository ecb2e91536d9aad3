// SPDX-License-Identifier: Apache-2.0
// Keys, their files, and lists of who may come with them.
#include "proto/keys.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "core/error.h"
#include "proto/key_files.h"
#include "proto/key_lines.h"
#include "proto/rights.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

class KeyFileTest : public testing::Test {
 protected:
  KeyFileTest() {
    const char* tmp = std::getenv("TMPDIR");
    std::string name = std::string(tmp ? tmp : "/tmp") + "/tessera-keys-XXXXXX";
    folder = mkdtemp(name.data());
  }
  ~KeyFileTest() override { fs::remove_all(folder); }
  fs::path file(const std::string& text, mode_t mode = 0600) {
    const fs::path path = folder / "file";
    fs::remove(path);
    std::ofstream(path) << text;
    chmod(path.c_str(), mode);
    return path;
  }
  fs::path folder;
};

TEST(Keys, AreNewEachTimeAndText) {
  const KeyPair one = make_key_pair(), other = make_key_pair();
  EXPECT_TRUE(is_key(one.public_key) && is_key(one.secret_key));
  EXPECT_NE(one.secret_key, other.secret_key);
  EXPECT_NE(one.public_key, one.secret_key);
  EXPECT_FALSE(is_key(one.public_key.substr(1)));
  EXPECT_FALSE(is_key(one.public_key + "x"));
  EXPECT_FALSE(is_key(std::string(kKeyText, '"')));
}

TEST_F(KeyFileTest, WhatIsWrittenIsReadAgain) {
  const KeyPair pair = make_key_pair();
  write_key_files(folder / "ada", pair);
  EXPECT_EQ(read_secret_key(folder / "ada.key"), pair);
  EXPECT_THAT(read_public_keys(folder / "ada.pub"), testing::ElementsAre(pair.public_key));
  EXPECT_EQ(fs::status(folder / "ada.key").permissions(), fs::perms::owner_read | fs::perms::owner_write);
}

TEST_F(KeyFileTest, NothingIsWrittenOver) {
  const KeyPair pair = make_key_pair();
  write_key_files(folder / "ada", pair);
  EXPECT_THAT([&] { write_key_files(folder / "ada", make_key_pair()); },
              ThrowsMessage<Error>(HasSubstr("is there already")));
  fs::remove(folder / "ada.pub");
  EXPECT_THROW(write_key_files(folder / "ada", make_key_pair()), Error);
  EXPECT_EQ(read_secret_key(folder / "ada.key"), pair);
  EXPECT_THROW(write_key_files(folder / "missing" / "ada", pair), Error);
}

TEST_F(KeyFileTest, ASecretThatOthersMayUseIsRefused) {
  const std::string text = "secret-key " + make_key_pair().secret_key + "\n";
  for (const mode_t mode : {0640, 0604, 0620, 0601})
    EXPECT_THAT([&] { read_secret_key(file(text, mode)); }, ThrowsMessage<Error>(HasSubstr("chmod 600")));
  EXPECT_NO_THROW(read_secret_key(file(text, 0400)));
}

TEST_F(KeyFileTest, FilesThatHoldNoKeySayWhereAndWhatIsAccepted) {
  const std::string key = make_key_pair().secret_key;
  for (const std::string& text : {std::string("secret-key\n"), std::string("secret-key x\n"),
                                  "public-key " + key, "secret-key " + key + " more", key})
    EXPECT_THAT([&] { read_secret_key(file("# key\n" + text)); },
                ThrowsMessage<Error>(testing::AllOf(HasSubstr("file:2: "), HasSubstr("accepted: "))))
        << text;
  EXPECT_THROW(read_secret_key(file("")), Error);
  EXPECT_THROW(read_secret_key(file("secret-key " + key + "\nsecret-key " + key)), Error);
  EXPECT_THROW(read_secret_key(folder / "missing"), Error);
  EXPECT_THROW(read_secret_key(folder), Error);
  EXPECT_THROW(read_public_keys("/dev/zero"), Error);
}

TEST_F(KeyFileTest, NeedsBothFilesOrNone) {
  EXPECT_FALSE(read_server_keys({}));
  EXPECT_FALSE(read_client_keys({}));
  EXPECT_THAT([] { read_server_keys({.key = "a.key"}); }, ThrowsMessage<Error>(HasSubstr("--allow")));
  EXPECT_THAT([] { read_server_keys({.allow = "allow"}); }, ThrowsMessage<Error>(HasSubstr("--key")));
  EXPECT_THAT([] { read_client_keys({.key = "a.key"}); }, ThrowsMessage<Error>(HasSubstr("--server-key")));
  const KeyPair server = make_key_pair(), ada = make_key_pair();
  write_key_files(folder / "server", server);
  write_key_files(folder / "ada", ada);
  const auto keys = read_client_keys({.key = folder / "ada.key", .server_key = folder / "server.pub"});
  EXPECT_EQ(keys, (ClientKeys{ada, {server.public_key}}));
}

const std::string kKey(kKeyText, '#');  // which a key may well hold

TEST(AllowList, SaysWhoHasWhichRoles) {
  const std::string other(kKeyText, 'b');
  const AllowList list =
      parse_allow_list("# the farm\n\n  worker\track1 " + kKey +
                           "  # in the cellar\r\nadministrator,submitter ada " + other + "\n",
                       "list");
  ASSERT_EQ(list.keys.size(), 2u);
  EXPECT_EQ(*list.find(kKey), (Identity{"rack1", true, false, false}));
  EXPECT_EQ(*list.find(other), (Identity{"ada", false, true, true}));
  EXPECT_EQ(list.find(std::string(kKeyText, 'c')), nullptr);
}

TEST(AllowList, ANameMayHaveTwoKeysWithTheSameRoles) {
  const std::string line = "worker rack " + kKey + "\n", other = "rack " + std::string(kKeyText, 'b');
  EXPECT_EQ(parse_allow_list(line + "worker " + other, "list").keys.size(), 2u);
  EXPECT_THAT([&] { parse_allow_list(line + "submitter " + other, "list"); },
              ThrowsMessage<Error>(HasSubstr("list:2: 'rack' has other roles")));
}

TEST(AllowList, ErrorsSayWhereWhatAndWhatIsAccepted) {
  const std::pair<std::string, std::string> cases[] = {
      {"worker rack", "list:2: has 2 words; accepted: ROLE[,ROLE] NAME PUBLIC-KEY"},
      {"worker rack " + kKey + " more", "list:2: has 4 words"},
      {"wroker rack " + kKey, "list:2: unknown role 'wroker'; did you mean 'worker'?; accepted: worker, "},
      {"worker, rack " + kKey, "list:2: unknown role ''"},
      {"worker rack/1 " + kKey, "list:2: 'rack/1' is no name"},
      {"worker local " + kKey, "list:2: 'local' is no name"},
      {"worker " + std::string(33, 'n') + " " + kKey, "is no name"},
      {"worker rack " + kKey.substr(1), "is no public key"},
      {"worker rack " + kKey + "\nworker barn " + kKey, "list:3: the key is there already"},
      {"worker ra\x01k " + kKey, "list:2: is no line of text"},
      {"", "list: allows nobody"},
  };
  for (const auto& [text, error] : cases)
    EXPECT_THAT([&] { parse_allow_list("# list\n" + text, "list"); }, ThrowsMessage<Error>(HasSubstr(error)))
        << text;
}

TEST(Rights, OfEachRole) {
  const Identity worker{"w", true, false, false}, submitter{"s", false, true, false},
      administrator{"a", false, false, true};
  EXPECT_TRUE(may_say(worker, Hello{}) && may_say(worker, Ask{}));
  EXPECT_TRUE(!may_say(submitter, Hello{}) && may_say(submitter, Ask{}));
  EXPECT_TRUE(!may_say(administrator, RenderDone{}) && may_say(administrator, Ask{}));
  for (const Question& look : {Question(GetPiece{}), Question(ListJobs{}), Question(ListWorkers{})})
    for (const Identity& who : {worker, submitter, administrator}) EXPECT_FALSE(why_not(who, look));
  for (const Question& change :
       {Question(WhichLack{}), Question(PutPiece{}), Question(Submit{}), Question(Control{})}) {
    EXPECT_THAT(why_not(worker, change).value_or(""), HasSubstr("'w' may not"));
    EXPECT_FALSE(why_not(submitter, change));
    EXPECT_FALSE(why_not(administrator, change));
  }
  EXPECT_TRUE(why_not(submitter, ReleaseWorker{}));
  EXPECT_FALSE(why_not(administrator, ReleaseWorker{}));
}

}  // namespace
}  // namespace tessera
