// SPDX-License-Identifier: Apache-2.0
// What happens when there is no room in the middle of a record, a blob or a transaction: it is said, and all
// is as before.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/resource.h>
#include <sys/statvfs.h>
#include <sys/wait.h>
#include <unistd.h>

#include <functional>

#include "coordinator/store/store.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;

// While it lives, no file of this process grows beyond so many bytes: writing there fails (EFBIG).
class FileSizeLimit {
 public:
  explicit FileSizeLimit(rlim_t bytes) {
    ::signal(SIGXFSZ, SIG_IGN);
    ::getrlimit(RLIMIT_FSIZE, &before_);
    const rlimit limit{bytes, before_.rlim_max};
    ::setrlimit(RLIMIT_FSIZE, &limit);
  }
  FileSizeLimit(const FileSizeLimit&) = delete;
  FileSizeLimit& operator=(const FileSizeLimit&) = delete;
  ~FileSizeLimit() { ::setrlimit(RLIMIT_FSIZE, &before_); }

 private:
  rlimit before_{};
};

Accepted accepted(int n) {
  return {RenderTask{{0, 0, 64, 64}, {8 * n, 8 * n + 8}}, 1, {}, "worker", "class", 0.5, 0};
}

void append(Journal& journal, int n) {
  Accepted task = accepted(n);
  journal.append(task, Image({0, 0, 64, 64}, 8, static_cast<float>(n)));  // 128 KiB
}

std::size_t entries_in(Journal& journal) {
  std::size_t count = 0;
  journal.replay([&](const LoggedEvent& logged) {
    EXPECT_EQ(logged.pixels.at(7, 63, 63), static_cast<float>(count));
    ++count;
    return true;
  });
  return count;
}

JobRecord numbered_job(int n) {
  return {.job = "job-" + std::to_string(n), .submission = sha256(""), .name = std::string(200, 'n')};
}

void add_jobs(Store& store, int from, int count) {
  Store::Transaction together(store);
  std::vector<FrameRecord> frames(100);
  for (int i = 0; i < 100; ++i) frames[i].place = i;
  for (int n = from; n < from + count; ++n) store.add(numbered_job(n), frames, {});
  together.commit();
}

std::size_t files_below(const fs::path& folder) {
  std::size_t count = 0;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) count += entry.is_regular_file();
  return count;
}

TEST(Full, InTheMiddleOfARecordTheJournalIsAsBefore) {
  Folder folder;
  Journal journal(folder.path(), "frame");
  append(journal, 0);
  {
    const FileSizeLimit limit(journal.bytes() + 1000);
    for (int times = 0; times < 3; ++times) EXPECT_THROW(append(journal, 1), StoreFull);
    EXPECT_EQ(fs::file_size(folder.path() / "0.journal"), journal.bytes());
  }
  append(journal, 1);
  EXPECT_EQ(entries_in(journal), 2u);
  Journal again(folder.path(), "frame");
  EXPECT_EQ(again.found().thrown_away, "");
  EXPECT_EQ(entries_in(again), 2u);
}

TEST(Full, InTheMiddleOfACheckpointTheJournalIsAsBefore) {
  Folder folder;
  Journal journal(folder.path(), "frame");
  append(journal, 0);
  Checkpoint checkpoint;
  checkpoint.frame.sums = Image({0, 0, 64, 64}, 64);
  for (const rlim_t room : {rlim_t{20}, rlim_t{100'000}}) {  // in its journal; in its planes
    const FileSizeLimit limit(room);
    EXPECT_THROW(journal.restart(checkpoint), StoreFull);
    EXPECT_EQ(files_below(folder.path()), 1u);
  }
  append(journal, 1);
  EXPECT_EQ(entries_in(journal), 2u);
  journal.restart(checkpoint);
  EXPECT_TRUE(journal.checkpoint());
  EXPECT_EQ(entries_in(journal), 0u);
}

TEST(Full, InTheMiddleOfABlobItIsNotThere) {
  Folder folder;
  BlobStore store(folder.path());
  const std::string bytes(100'000, 'b');
  {
    const FileSizeLimit limit(50'000);
    EXPECT_THROW(store.put(bytes), StoreFull);
    EXPECT_EQ(files_below(folder.path()), 0u);
    EXPECT_EQ(store.take_piece(sha256(bytes), bytes.size(), 0, bytes.substr(0, 40'000)), 40'000u);
    EXPECT_THROW(store.take_piece(sha256(bytes), bytes.size(), 40'000, bytes.substr(40'000)), StoreFull);
    EXPECT_EQ(store.known(sha256(bytes)).have, 40'000u);
    EXPECT_EQ(store.bytes(), 40'000u);
  }
  EXPECT_EQ(store.take_piece(sha256(bytes), bytes.size(), 40'000, bytes.substr(40'000)), bytes.size());
  EXPECT_EQ(store.read(sha256(bytes)), bytes);
}

TEST(Full, InTheMiddleOfATransactionNothingOfItCounts) {
  Folder folder;
  Store store(folder.path());
  add_jobs(store, 0, 10);
  {
    const FileSizeLimit limit(fs::file_size(folder.path() / "store.sqlite-wal") + 10'000);
    EXPECT_THROW(add_jobs(store, 10, 50), StoreFull);
    EXPECT_THROW(for (int n = 10; n < 1000; ++n) store.add(numbered_job(n), {}, {}), StoreFull);
  }
  const std::size_t before = store.jobs(0, 9999).size();
  EXPECT_GE(before, 10u);
  add_jobs(store, 2000, 50);
  EXPECT_EQ(store.jobs(0, 9999).size(), before + 50);
  EXPECT_EQ(store.frames(store.job("job-2049")->number, 0, 999).size(), 100u);
}

// Leaves so much room on the file system of `folder`.
void leave_room(const fs::path& folder, std::uint64_t bytes) {
  struct statvfs status;
  ASSERT_EQ(::statvfs(folder.c_str(), &status), 0);
  const std::uint64_t free = status.f_bavail * status.f_frsize;
  ASSERT_GT(free, bytes);
  const int file = ::open((folder / "filler").c_str(), O_CREAT | O_RDWR, 0600);
  ASSERT_EQ(::posix_fallocate(file, 0, static_cast<off_t>(free - bytes)), 0);
  ::close(file);
}

// On a small file system of its own: ENOSPC.
void fill_up(const fs::path& folder) {
  const std::string bytes(200'000, 'b');
  Store store(folder / "store");
  store.add(numbered_job(0), {}, {});
  Journal journal = store.journal(1, 0, "frame");
  append(journal, 0);
  leave_room(folder, 100'000);
  for (int times = 0; times < 2; ++times) {
    EXPECT_THROW(append(journal, 1), StoreFull);
    EXPECT_THROW(store.blobs().put(bytes), StoreFull);
    EXPECT_THROW(add_jobs(store, 1, 50), StoreFull);
  }
  EXPECT_THROW(store.checkpoint(1, 0, journal, {.frame = {.sums = Image({0, 0, 64, 64}, 8)}}), StoreFull);
  EXPECT_EQ(store.jobs(0, 99).size(), 1u);
  EXPECT_EQ(store.blobs().bytes(), 0u);
  EXPECT_EQ(entries_in(journal), 1u);
  fs::remove(folder / "filler");
  append(journal, 1);
  EXPECT_EQ(entries_in(journal), 2u);
  EXPECT_EQ(store.blobs().read(store.blobs().put(bytes)), bytes);
  add_jobs(store, 1, 50);
  EXPECT_EQ(store.jobs(0, 99).size(), 51u);
}

// In a child that has a small file system at `folder`. False: it could not be made.
bool on_small_disk(const fs::path& folder, const std::function<void(const fs::path&)>& test) {
  constexpr int kNoDisk = 77;
  const pid_t child = ::fork();
  if (child == 0) {
    if (::unshare(CLONE_NEWNS | (::geteuid() == 0 ? 0 : CLONE_NEWUSER)) != 0 ||
        ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) != 0 ||
        ::mount("tmpfs", folder.c_str(), "tmpfs", 0, "size=8m") != 0)
      ::_exit(kNoDisk);
    try {
      test(folder);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
    }
    ::_exit(testing::Test::HasFailure() ? 1 : 0);
  }
  int status = 0;
  ::waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == kNoDisk) return false;
  EXPECT_TRUE(WIFEXITED(status) && WEXITSTATUS(status) == 0) << "see above";
  return true;
}

TEST(Full, ADiskThatIsFullIsSaidAndLeavesAllAsBefore) {
  Folder folder;
  if (!on_small_disk(folder.path(), fill_up)) GTEST_SKIP() << "no file system may be mounted here";
}

}  // namespace
}  // namespace tessera
