// SPDX-License-Identifier: Apache-2.0
// What it costs a coordinator to remember: results a second, bytes a second, and how long it takes to go on.
#include <fmt/format.h>

#include <chrono>
#include <ctime>
#include <filesystem>
#include <functional>
#include <string>

#include "coordinator/store/store.h"
#include "proto/clock.h"

namespace {

using namespace tessera;

constexpr std::uint64_t kJob = 1;

struct Spent {
  double seconds = 0, processor = 0;
};

Spent spent_on(const std::function<void()>& work) {
  const Instant begun = clock_now();
  const std::clock_t worked = std::clock();
  work();
  return {seconds_between(begun, clock_now()), static_cast<double>(std::clock() - worked) / CLOCKS_PER_SEC};
}

void row(const std::string& what, double count, double bytes, const Spent& spent) {
  fmt::print("{:<58} {:>9.0f} /s {:>7.0f} MB/s; of a processor {:>9.1f} us each, {:>5.0f} MB/s\n", what,
             count / spent.seconds, bytes / spent.seconds / 1e6, spent.processor / count * 1e6,
             bytes / spent.processor / 1e6);
}

Accepted accepted(int n) {
  const int x = n % 64 * 64, y = n / 64 % 64 * 64, begin = 8 * (n / 4096);
  return {RenderTask{{x, y, x + 64, y + 64}, {begin, begin + 8}},
          1,
          {},
          "render-017-4242",
          "avx512 pocl-3.1",
          0.5,
          0};
}

// `count` results of `edge` x `edge` pixels of `planes` planes: written, found again, ended.
void results(const std::filesystem::path& folder, int count, int edge, int planes) {
  const Image pixels({0, 0, edge, edge}, planes, 0.5f);
  const double each = static_cast<double>(pixels.data().size_bytes());
  const std::string what = fmt::format("{} results of {:.0f} KiB", count, each / 1024);
  Store store(folder / "store");
  std::vector<FrameRecord> frames(1);
  frames[0].state = FrameState::active;
  store.add({.job = "job", .submission = sha256("")}, frames, {});
  {
    Journal journal = store.journal(kJob, 0, "frame");
    row(what + ", written", count, count * each, spent_on([&] {
          for (int n = 0; n < count; ++n) {
            Accepted task = accepted(n);
            journal.append(task, pixels);
          }
        }));
  }
  std::optional<Journal> journal;
  row(what + ", found sound on opening", count, count * each,
      spent_on([&] { journal.emplace(store.journal(kJob, 0, "frame")); }));
  row(what + ", read", count, count * each,
      spent_on([&] { journal->replay([](const LoggedEvent&) { return true; }); }));
  frames[0].state = FrameState::completed;
  row(what + ", to rows at the frame's end", count, count * each,
      spent_on([&] { store.finish(kJob, frames[0], std::move(*journal)); }));
  store.collect(0);
  fmt::print("{:<58} {:>9.0f} bytes a task, of the database\n", "",
             static_cast<double>(std::filesystem::file_size(folder / "store" / "store.sqlite-wal") +
                                 std::filesystem::file_size(folder / "store" / "store.sqlite")) /
                 count);
  std::filesystem::remove_all(folder / "store");
}

void checkpoints(const std::filesystem::path& folder) {
  Checkpoint checkpoint;
  checkpoint.frame.round = 2;
  checkpoint.frame.sums = Image({0, 0, 1920, 1080}, 60, 0.5f);
  Journal journal(folder / "journal", "frame");
  const double bytes = static_cast<double>(checkpoint.frame.sums.data().size_bytes());
  row("a checkpoint of 1920 x 1080 x 60 planes, written", 1, bytes,
      spent_on([&] { journal.restart(checkpoint); }));
  row("a checkpoint of 1920 x 1080 x 60 planes, found and read", 1, bytes,
      spent_on([&] { Journal(folder / "journal", "frame").checkpoint(); }));
  std::filesystem::remove_all(folder / "journal");
}

void blobs(const std::filesystem::path& folder) {
  for (const bool sync : {true, false}) {
    BlobStore store(folder / "store", {.sync = sync});
    const std::string with = sync ? ", for good" : ", without sync";
    int salt = 0;
    const auto put = [&](std::size_t bytes, int count) {
      std::string blob(bytes, 'b');
      row(fmt::format("{} files of {} KiB{}", count, bytes / 1024, with), count,
          double(count) * double(bytes), spent_on([&] {
            for (int i = 0; i < count; ++i) {
              blob.replace(0, 8, fmt::format("{:08}", ++salt));
              store.put(blob);
            }
          }));
    };
    put(4 << 10, 200);
    put(8 << 20, 10);
    const std::string large(256 << 20, sync ? 'l' : 'm');
    const Digest digest = sha256(large);
    row("256 MiB in pieces of 128 KiB" + with, 2048, double(large.size()), spent_on([&] {
          for (std::size_t at = 0; at < large.size(); at += kPieceBytes)
            store.take_piece(digest, large.size(), at, std::string_view(large).substr(at, kPieceBytes));
        }));
    std::filesystem::remove_all(folder / "store");
  }
}

void transactions(const std::filesystem::path& folder) {
  Store store(folder / "store");
  store.add({.job = "job", .submission = sha256("")}, {}, {});
  row("events, each a transaction", 5000, 0, spent_on([&] {
        for (int i = 0; i < 5000; ++i) store.add_event(kJob, i, "frame 17 begins");
      }));
  std::filesystem::remove_all(folder / "store");
}

}  // namespace

int main(int argc, char** argv) {
  const std::filesystem::path folder =
      argc > 1 ? argv[1] : std::filesystem::temp_directory_path() / "tessera-store-bench";
  std::filesystem::remove_all(folder);
  std::filesystem::create_directories(folder);
  results(folder, 100'000, 4, 16);
  results(folder, 20'000, 16, 16);
  results(folder, 500, 64, 60);
  results(folder, 100, 256, 60);
  checkpoints(folder);
  blobs(folder);
  transactions(folder);
  std::filesystem::remove_all(folder);
}
