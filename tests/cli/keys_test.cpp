// SPDX-License-Identifier: Apache-2.0
// tessera keygen, the options that name keys, and keys that change while a process runs.
#include <gmock/gmock.h>

#include <condition_variable>
#include <mutex>

#include "cli/key_options.h"
#include "cli/key_watch.h"
#include "proto/clock.h"
#include "tests/cli/program.h"

namespace tessera {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class CliKeys : public testing::Test {
 protected:
  CliKeys() {
    std::string name = (fs::temp_directory_path() / "tessera-cli-keys-XXXXXX").string();
    folder = mkdtemp(name.data());
  }
  ~CliKeys() override { fs::remove_all(folder); }
  // As people should: a file that is whole when it appears.
  void put(const std::string& name, const std::string& text) {
    std::ofstream(folder / "new") << text;
    fs::rename(folder / "new", folder / name);
  }
  fs::path folder;
};

TEST_F(CliKeys, KeygenWritesTwoFilesAndPrintsWhatOthersMayHave) {
  const std::string stem = folder / "ada";
  const Outcome made = run({"keygen", "-o", stem});
  EXPECT_EQ(made.code, 0) << made.text;
  const KeyPair pair = read_secret_key(stem + ".key");
  EXPECT_EQ(made.text, "public-key " + pair.public_key + "\n");
  EXPECT_THAT(read_public_keys(stem + ".pub"), testing::ElementsAre(pair.public_key));
  const Outcome again = run({"keygen", "-o", stem});
  EXPECT_EQ(again.code, 2);
  EXPECT_THAT(again.text, HasSubstr("is there already"));
  EXPECT_EQ(read_secret_key(stem + ".key"), pair);
}

TEST_F(CliKeys, KeygenRefusesPlacesThatAreNone) {
  EXPECT_EQ(run({"keygen"}).code, 2);
  EXPECT_EQ(run({"keygen", "-o", folder.string() + "/"}).code, 2);
  const Outcome nowhere = run({"keygen", "-o", folder / "missing" / "ada"});
  EXPECT_EQ(nowhere.code, 3);
  EXPECT_THAT(nowhere.text, HasSubstr("cannot be written"));
}

TEST_F(CliKeys, AreNamedByOptionsOrTheEnvironment) {
  const auto parse = [](std::string text, bool server) {
    CLI::App app;
    KeyFiles files;
    server ? add_server_key_options(app, files) : add_client_key_options(app, files);
    app.parse(std::move(text));
    return files;
  };
  EXPECT_EQ(parse("--key a.key --allow list", true).allow, "list");
  EXPECT_EQ(parse("--key a.key --server-key farm.pub", false).server_key, "farm.pub");
  setenv("TESSERA_KEY", "env.key", 1);
  setenv("TESSERA_SERVER_KEY", "env.pub", 1);
  EXPECT_EQ(parse("", false).key, "env.key");
  EXPECT_EQ(parse("", false).server_key, "env.pub");
  EXPECT_EQ(parse("--key a.key", false).key, "a.key");
  unsetenv("TESSERA_KEY");
  unsetenv("TESSERA_SERVER_KEY");
}

// What a watch has said, waited for.
class Heard {
 public:
  void say(std::string_view line) {
    const std::lock_guard lock(mutex_);
    lines_.emplace_back(line);
    bell_.notify_all();
  }
  std::string line(std::size_t n) {
    std::unique_lock lock(mutex_);
    bell_.wait_for(lock, std::chrono::seconds{30}, [&] { return lines_.size() > n; });
    return lines_.size() > n ? lines_[n] : "nothing was said";
  }

 private:
  std::mutex mutex_;
  std::vector<std::string> lines_;
  std::condition_variable bell_;
};

TEST_F(CliKeys, ChangedFilesAreTakenOverAndBadOnesAreNot) {
  const KeyPair server = make_key_pair(), ada = make_key_pair(), bob = make_key_pair();
  write_key_files(folder / "farm", server);
  put("allow", "submitter ada " + ada.public_key + "\n");
  const KeyFiles files{.key = folder / "farm.key", .allow = folder / "allow", .server_key = {}};
  ZmqContext context;
  ZmqRouter router(context, {"tcp://127.0.0.1:*"}, {}, read_server_keys(files));
  ZmqDealer dealer(context, router.endpoints()[0], "bob", {}, ClientKeys{bob, {server.public_key}});
  Heard heard;
  KeyWatch watch(
      files, router, [&](std::string_view line) { heard.say(line); }, Millis{2});

  put("allow", "submitter ada " + ada.public_key + "\nsubmitter bob nonsense\n");
  EXPECT_THAT(heard.line(0),
              testing::AllOf(StartsWith("keys: NOT changed"), HasSubstr("allow:2: 'nonsense'")));
  put("allow", "submitter bob " + bob.public_key + "\n");
  EXPECT_THAT(heard.line(1),
              StartsWith("keys: 1 allowed from now on; this coordinator's is " + server.public_key));
  std::optional<Mail> mail;
  for (const Instant end = clock_now() + std::chrono::seconds{30}; !mail && clock_now() < end;) {
    dealer.send("coordinator", Ask{1, ListJobs{}});
    dealer.receive(clock_now());
    mail = router.receive(clock_now() + Millis{5});
  }
  ASSERT_TRUE(mail);
  EXPECT_EQ(mail->who.name, "bob");
  fs::remove(folder / "allow");
  EXPECT_THAT(heard.line(2), StartsWith("keys: NOT changed"));
  put("allow", "submitter ada " + ada.public_key + "\n");
  EXPECT_THAT(heard.line(3), StartsWith("keys: 1 allowed"));
  watch.look();
  EXPECT_THAT(heard.line(4), StartsWith("keys: 1 allowed"));
}

}  // namespace
}  // namespace tessera
