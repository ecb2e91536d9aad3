// SPDX-License-Identifier: Apache-2.0
// A process that writes to a store and says what is written is killed at random instants: all it said is
// there.
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <random>
#include <set>
#include <vector>

#include "coordinator/store/store.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

constexpr int kKills = 50, kFirst = 10, kFrames = 3;
constexpr std::uint64_t kJob = 1;

// What happens as number n: one of these. Each kind is numbered by n.
enum Kind { entry, blob, upload, job, restart, kKinds };
Kind kind_of(int n) {
  constexpr Kind kOrder[] = {entry, blob, entry, job, entry, upload, entry, entry, entry, restart};
  return kOrder[n % 10];
}

std::string name_of(int n) { return "job-" + std::to_string(n); }

std::string bytes_of_blob(int n) {
  std::string bytes = std::to_string(n) + " ";
  bytes.resize(20'000 + n % 1000, static_cast<char>(n));
  return bytes;
}

Image pixels_of(int n) { return Image({0, 0, 64, 32}, 5, static_cast<float>(n)); }

Accepted accepted(int n) {
  return {RenderTask{{0, 0, 64, 32}, {8 * n, 8 * n + 8}}, 1, {}, "worker", "class", 0.5, 0};
}
int number_of(const Accepted& task) { return std::get<RenderTask>(task.work).samples.begin / 8; }

void add_job(Store& store, int n) {
  Store::Transaction together(store);
  std::vector<FrameRecord> frames(kFrames);
  for (int i = 0; i < kFrames; ++i) frames[i].place = i;
  const Store::Added added = store.add({.job = name_of(n), .submission = sha256(name_of(n))}, frames, {});
  if (added.fresh) store.add_event(added.job.number, n, "submitted");
  together.commit();
}

void write(Store& store, Journal& journal, int n) {
  const std::string bytes = bytes_of_blob(n);
  Accepted task = accepted(n);
  switch (kind_of(n)) {
    case entry:
      return journal.append(task, pixels_of(n));
    case blob:
      store.blobs().put(bytes);
      return;
    case upload:
      for (std::size_t at = store.blobs().known(sha256(bytes)).have; at < bytes.size(); at += 5000)
        store.blobs().take_piece(sha256(bytes), bytes.size(), at, std::string_view(bytes).substr(at, 5000));
      return;
    case job:
      return add_job(store, n);
    default:
      Checkpoint checkpoint;
      checkpoint.frame.round = n;
      checkpoint.frame.sums = pixels_of(n);
      return store.checkpoint(kJob, 0, journal, checkpoint);
  }
}

// Never returns: writes from number n on, and says each number once it is written.
[[noreturn]] void work(const std::filesystem::path& folder, int n, int pipe) {
  Store store(folder, {.sync = false});
  Journal journal = store.journal(kJob, 0, "frame");
  for (;; ++n) {
    write(store, journal, n);
    if (::write(pipe, &n, sizeof n) != sizeof n) ::_exit(1);
  }
}

// Kills a worker that went on from `first` when it has said `count` numbers, and a little later. The last it
// said.
int last_said(const std::filesystem::path& folder, int first, int count, int later_us) {
  int ends[2];
  if (::pipe(ends) != 0) throw std::runtime_error("no pipe");
  const pid_t child = ::fork();
  if (child == 0) {
    ::close(ends[0]);
    try {
      work(folder, first, ends[1]);
    } catch (const std::exception& error) {
      ADD_FAILURE() << error.what();
      ::_exit(1);
    }
  }
  ::close(ends[1]);
  int last = first - 1;
  const auto hear = [&] { return ::read(ends[0], &last, sizeof last) == sizeof last; };
  for (int i = 0; i < count && hear(); ++i) {
  }
  ::usleep(later_us);
  ::kill(child, SIGKILL);
  int status = 0;
  ::waitpid(child, &status, 0);
  EXPECT_TRUE(WIFSIGNALED(status)) << "it ended by itself";
  while (hear()) {
  }
  ::close(ends[0]);
  return last;
}

// Entries up to the last restart are rows, later ones are in the journal.
void check_entries(Store& store, int last) {
  Journal journal = store.journal(kJob, 0, "frame");
  const auto checkpoint = journal.checkpoint();
  const int restarted = checkpoint ? checkpoint->frame.round : kFirst;
  EXPECT_TRUE(!checkpoint || same_bits(checkpoint->frame.sums, pixels_of(restarted)));
  std::set<int> entries;
  journal.replay([&](const LoggedEvent& logged) {
    const int n = number_of(std::get<Accepted>(logged.event));
    entries.insert(n);
    EXPECT_TRUE(same_bits(logged.pixels, pixels_of(n)));
    return true;
  });
  std::uint64_t rows = 0;
  for (int n = kFirst; n <= last; ++n) {
    if (kind_of(n) != entry) continue;
    rows += n < restarted;
    EXPECT_TRUE(n < restarted || entries.contains(n)) << n;
  }
  EXPECT_GE(store.accepted_count(kJob), rows);
}

// All of [first, last] is there and whole, and of nothing there is half.
void check(Store& store, int first, int last) {
  check_entries(store, last);
  for (int n = first; n <= last; ++n) {
    const Kind kind = kind_of(n);
    EXPECT_TRUE(kind != job || store.job(name_of(n))) << n;
    if (kind == blob || kind == upload) {
      EXPECT_EQ(store.blobs().read(sha256(bytes_of_blob(n))), bytes_of_blob(n));
    }
  }
  for (const JobRecord& found : store.jobs(kJob, 1'000'000)) {
    EXPECT_EQ(store.frames(found.number, 0, 99).size(), std::size_t{kFrames}) << found.job;
    EXPECT_EQ(store.events(found.number, 0, 99).size(), 1u) << found.job;
  }
}

TEST(Kill, AtAnyInstantLosesNothingThatWasWrittenAndLeavesNothingHalf) {
  Folder folder;
  {
    Store store(folder.path());
    std::vector<FrameRecord> frames(1);
    frames[0].state = FrameState::active;
    store.add({.job = "the-frame", .submission = sha256("")}, frames, {});
  }
  std::mt19937 random(7);
  int next = kFirst;
  for (int kill = 0; kill < kKills; ++kill) {
    const int last = last_said(folder.path(), next, random() % 40, random() % 3000);
    Store store(folder.path());
    check(store, next, last);
    ASSERT_FALSE(HasFailure()) << "after kill " << kill;
    next = last + 1;  // which may be there already, or not
  }
  EXPECT_GT(next, 10 * kKills) << "hardly anything was written";
  Store store(folder.path());
  check(store, kFirst, next - 1);
}

}  // namespace
}  // namespace tessera
