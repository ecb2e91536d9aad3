// SPDX-License-Identifier: Apache-2.0
// Which stores are opened, and which are refused.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>

#include "coordinator/store/store.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::ThrowsMessage;

TEST(Store, ASecondCoordinatorIsRefusedAndToldWhoHasIt) {
  Folder folder;
  Store store(folder.path());
  EXPECT_THAT(
      [&] { Store second(folder.path()); },
      ThrowsMessage<Error>(AllOf(HasSubstr(folder.path().string()), HasSubstr(std::to_string(::getpid())))));
  try {
    Store second(folder.path());
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_usage);
  }
}

std::string message_of_opening(const fs::path& folder) {
  try {
    Store store(folder);
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ExitCode::bad_input) << error.what();
    return error.what();
  }
  return "it was opened";
}

TEST(Store, ADamagedDatabaseIsRefusedWithWhatCanBeDone) {
  Folder folder;
  {
    Store store(folder.path());
    const std::vector<FrameRecord> frames(1);
    for (int i = 0; i < 200; ++i)
      store.add({.job = "job-" + std::to_string(i), .submission = sha256("")}, frames, {});
  }
  const fs::path file = folder.path() / "store.sqlite";
  for (std::uintmax_t page = 1; page < fs::file_size(file) / 4096; ++page)
    std::fstream(file, std::ios::in | std::ios::out | std::ios::binary).seekp(page * 4096)
        << "xxxxxxxxxxxxxxxx";
  EXPECT_THAT(message_of_opening(folder.path()), AllOf(HasSubstr("damaged"), HasSubstr("move it aside")));
  std::ofstream(file, std::ios::trunc | std::ios::binary) << std::string(100'000, 'x');
  EXPECT_THAT(message_of_opening(folder.path()), HasSubstr("damaged"));
  fs::remove(file);
  Store store(folder.path());
  EXPECT_TRUE(store.jobs(0, 9).empty());
}

TEST(Store, OfALaterVersionOrOfAnotherProgramIsRefused) {
  Folder folder;
  { Store store(folder.path()); }
  const std::string file = (folder.path() / "store.sqlite").string();
  const auto sqlite = [&](const std::string& sql) {
    return std::system(("sqlite3 '" + file + "' '" + sql + "'").c_str()) == 0;
  };
  if (std::system("command -v sqlite3 > /dev/null") != 0) GTEST_SKIP() << "sqlite3 is not installed";
  ASSERT_TRUE(sqlite("PRAGMA user_version = 99"));
  EXPECT_THAT(message_of_opening(folder.path()), HasSubstr("99"));
  ASSERT_TRUE(sqlite("PRAGMA user_version = 1; PRAGMA application_id = 5"));
  EXPECT_THAT(message_of_opening(folder.path()), HasSubstr("not a store"));
}

}  // namespace
}  // namespace tessera
