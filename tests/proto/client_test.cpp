// SPDX-License-Identifier: Apache-2.0
#include "proto/client.h"

#include <gmock/gmock.h>
#include <unistd.h>

#include <fstream>
#include <random>

#include "core/part_file.h"
#include "tests/proto/blob_server.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

const Weather kStorm{.seed = 0, .loss = 0.15, .repeat = 0.15, .delay_max = Millis{40}};

class Client : public testing::Test {
 protected:
  fs::path folder = fs::temp_directory_path() / ("tessera-client-test-" + std::to_string(getpid()));

  Client() { fs::create_directories(folder); }
  ~Client() override { fs::remove_all(folder); }

  static std::string contents(const fs::path& file) {
    std::ifstream in(file, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }
  static void write(const fs::path& file, const std::string& bytes) {
    std::ofstream(file, std::ios::binary) << bytes;
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(fs::directory_iterator(folder), {}));
  }
};

template <class F>
std::pair<ExitCode, std::string> failure_of(F&& work) {
  try {
    work();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  return {ExitCode::done, ""};
}

std::vector<std::string> blobs_of_all_sizes() {
  std::vector<std::string> all;
  for (const std::size_t n : {std::size_t{0}, std::size_t{1}, kPieceBytes - 1, kPieceBytes, kPieceBytes + 1,
                              5 * kPieceBytes, 40 * kPieceBytes + 77})
    all.push_back(noise(n, static_cast<unsigned>(n)));
  return all;
}

std::vector<BlobSource> sources_of(const std::vector<std::string>& blobs) {
  std::vector<BlobSource> sources;
  for (const std::string& blob : blobs) sources.push_back(blob_of(blob));
  return sources;
}

TEST_F(Client, GetsTheAnswerToItsQuestion) {
  BlobWorld world;
  EXPECT_EQ(world.client().ask(ShowJob{"a", 0}), Reply(Agreed{}));
  const Digest there = world.server.put("x"), lacking = sha256("y");
  EXPECT_EQ(world.client().ask(WhichLack{{there, lacking}}), Reply(Lacking{{{lacking, 0}}}));
}

TEST_F(Client, ADenialIsAnErrorOfItsCodeAndReason) {
  BlobWorld world;
  world.server.denies = Denied{ExitCode::job_failed, "there is no such job"};
  FarmClient client = world.client();
  EXPECT_EQ(failure_of([&] {
              client.ask(ShowJob{"a", 0});
            }),
            std::pair(ExitCode::job_failed, std::string("there is no such job")));
  world.server.denies.reset();
  EXPECT_EQ(client.ask(ShowJob{"a", 0}), Reply(Agreed{}));
}

TEST_F(Client, SilenceIsAnsweredByAskingAgainEverMoreSeldomAndThenUnreachable) {
  BlobWorld world;
  world.server.deaf = true;
  FarmClient client = world.client();
  const auto [code, reason] = failure_of([&] { client.ask(ListJobs{}); });
  EXPECT_EQ(code, ExitCode::unreachable);
  EXPECT_THAT(reason, HasSubstr("20.0 s"));
  EXPECT_EQ(world.now().time_since_epoch(), Millis{20'000});
  std::vector<int> asked;
  for (const Instant when : world.server.asked)
    asked.push_back(static_cast<int>(std::chrono::duration_cast<Millis>(when.time_since_epoch()).count()));
  EXPECT_EQ(asked, (std::vector{0, 500, 1500, 3500, 7500, 11500, 15500, 19500}));
  world.server.deaf = false;
  EXPECT_EQ(client.ask(ListJobs{}), Reply(Agreed{}));
}

TEST_F(Client, StopsWhenItIsTold) {
  BlobWorld world;
  world.server.deaf = true;
  FarmClient client = world.client([&] { return world.now().time_since_epoch() >= Millis{1000}; });
  EXPECT_EQ(failure_of([&] { client.ask(ListJobs{}); }).first, ExitCode::interrupted);
  EXPECT_EQ(world.now().time_since_epoch(), Millis{1000});
}

TEST_F(Client, BlobsOfAllSizesArriveInAnyWeather) {
  const std::vector<std::string> blobs = blobs_of_all_sizes();
  for (unsigned seed = 0; seed < 10; ++seed) {
    Weather weather = kStorm;
    weather.seed = seed;
    BlobWorld world(weather);
    world.client().upload(sources_of(blobs));
    for (const std::string& blob : blobs) {
      ASSERT_EQ(world.server.whole[sha256(blob)], blob) << "seed " << seed << ", " << blob.size();
      const fs::path file = folder / "blob";
      FarmClient client = world.client();
      client.download(sha256(blob), file);
      ASSERT_EQ(contents(file), blob) << "seed " << seed;
      ASSERT_EQ(client.download(sha256(blob), blob.size()), blob) << "seed " << seed;
    }
    EXPECT_EQ(files(), 1u) << "nothing is left of what was fetched";
  }
}

TEST_F(Client, OnAQuietRoadNothingGoesTwice) {
  BlobWorld world;
  const std::vector<std::string> blobs = blobs_of_all_sizes();
  std::uint64_t bytes = 0;
  for (const std::string& blob : blobs) bytes += blob.size();
  EXPECT_EQ(world.client().upload(sources_of(blobs)), bytes);
  EXPECT_EQ(world.server.put_bytes, bytes);
  EXPECT_EQ(world.client().upload(sources_of(blobs)), 0u);
  EXPECT_EQ(world.server.put_bytes, bytes) << "what is there is not sent again";
  world.client().download(sha256(blobs.back()), folder / "blob");
  EXPECT_EQ(world.server.got_pieces, 41u);
}

TEST_F(Client, SeveralPiecesAreOnTheRoadAtATime) {
  BlobWorld world({.seed = 1, .delay_min = Millis{50}, .delay_max = Millis{50}});
  const std::string blob = noise(160 * kPieceBytes, 3);
  world.client().upload({blob_of(blob)});
  EXPECT_LT(world.now().time_since_epoch(), Millis{1500}) << "10 windows, not 160 pieces, of 100 ms";
  const Instant begin = world.now();
  world.client().download(sha256(blob), folder / "blob");
  EXPECT_LT(world.now() - begin, Millis{1500});
}

TEST_F(Client, AnUploadThatWasCutOffGoesOnWhereItStopped) {
  BlobWorld world({.seed = 2, .delay_min = Millis{5}, .delay_max = Millis{5}});
  const std::string blob = noise(100 * kPieceBytes, 4);
  const auto half = [&] { return world.server.put_pieces >= 50; };
  EXPECT_EQ(failure_of([&] { world.client(half).upload({blob_of(blob)}); }).first, ExitCode::interrupted);
  EXPECT_FALSE(world.server.whole.contains(sha256(blob)));
  world.client().upload({blob_of(blob)});
  EXPECT_EQ(world.server.whole[sha256(blob)], blob);
  EXPECT_LE(world.server.put_pieces, 100 + ClientOptions{}.window);
}

TEST_F(Client, AnUploadSurvivesACoordinatorThatForgetsPiecesAsItStartsAnew) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    Weather weather = kStorm;
    weather.seed = seed;
    BlobWorld world(weather);
    world.server.crash_every = 97;
    const std::string blob = noise(60 * kPieceBytes + 5, seed);
    world.client().upload({blob_of(blob)});
    ASSERT_EQ(world.server.whole[sha256(blob)], blob) << "seed " << seed;
  }
}

TEST_F(Client, ACoordinatorThatKeepsNothingIsGivenUp) {
  BlobWorld world;
  world.server.forgets = true;
  const auto [code, reason] = failure_of([&] { world.client().upload({blob_of("abc")}); });
  EXPECT_EQ(code, ExitCode::internal_error);
  EXPECT_THAT(reason, HasSubstr("does not keep"));
}

TEST_F(Client, AFileThatChangesWhileItIsSentIsBadInput) {
  BlobWorld world;
  const std::string blob = noise(3 * kPieceBytes, 5);
  const fs::path file = folder / "texture.png";
  write(file, blob.substr(0, kPieceBytes));
  const auto [code, reason] =
      failure_of([&] { world.client().upload({blob_of(file, sha256(blob), blob.size())}); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_THAT(reason, HasSubstr("texture.png"));
  write(file, noise(3 * kPieceBytes, 6));
  EXPECT_EQ(failure_of([&] { world.client().upload({blob_of(file, sha256(blob), blob.size())}); }).first,
            ExitCode::bad_input);
  write(file, blob);
  world.client().upload({blob_of(file, sha256(blob), blob.size())});
  EXPECT_EQ(world.server.whole[sha256(blob)], blob);
}

TEST_F(Client, ADownloadThatWasCutOffGoesOnWhereItStopped) {
  BlobWorld world({.seed = 2, .delay_min = Millis{5}, .delay_max = Millis{5}});
  const std::string blob = noise(100 * kPieceBytes + 1, 7);
  const Digest digest = world.server.put(blob);
  const auto half = [&] { return world.server.got_pieces >= 50; };
  EXPECT_EQ(failure_of([&] { world.client(half).download(digest, folder / "blob"); }).first,
            ExitCode::interrupted);
  EXPECT_FALSE(fs::exists(folder / "blob"));
  world.client().download(digest, folder / "blob");
  EXPECT_EQ(contents(folder / "blob"), blob);
  EXPECT_LE(world.server.got_pieces, 101 + ClientOptions{}.window);
  EXPECT_EQ(files(), 1u);
}

TEST_F(Client, WhatIsLeftOfAnotherFileIsFetchedAnew) {
  BlobWorld world;
  const std::string blob = noise(3 * kPieceBytes, 8);
  const Digest digest = world.server.put(blob);
  for (const std::string& left :
       {noise(kPieceBytes, 9), noise(5 * kPieceBytes, 9), noise(3 * kPieceBytes, 9)}) {
    write(folder / "blob.part", left);
    world.client().download(digest, folder / "blob");
    EXPECT_EQ(contents(folder / "blob"), blob);
    fs::remove(folder / "blob");
  }
}

TEST_F(Client, TwoMayFetchTheSameFileAtATime) {
  BlobWorld world;
  const std::string blob = noise(3 * kPieceBytes, 8);
  const Digest digest = world.server.put(blob);
  PartFile other(folder / "blob");
  other.append(blob.substr(0, 100));
  world.client().download(digest, folder / "blob");
  EXPECT_EQ(contents(folder / "blob"), blob);
  other.append(blob.substr(100));
  EXPECT_TRUE(other.commit(digest));
  EXPECT_EQ(contents(folder / "blob"), blob);
  EXPECT_EQ(files(), 1u);
}

TEST_F(Client, BytesThatAreNotThoseOfTheDigestAreNeverAFile) {
  BlobWorld world;
  const Digest digest = world.server.put(noise(3 * kPieceBytes, 10));
  world.server.spoil = "\x55";
  FarmClient client = world.client();
  EXPECT_EQ(failure_of([&] { client.download(digest, folder / "blob"); }).first, ExitCode::internal_error);
  EXPECT_EQ(failure_of([&] { client.download(digest, 1 << 20); }).first, ExitCode::internal_error);
  EXPECT_EQ(files(), 0u);
  world.server.spoil = "longer than a piece may be";
  EXPECT_EQ(failure_of([&] { client.download(digest, 1 << 20); }).first, ExitCode::unreachable)
      << "what is no message is no answer";
}

TEST_F(Client, ABlobThatIsLongerThanItMayBeIsRefusedAtItsFirstPiece) {
  BlobWorld world;
  const Digest digest = world.server.put(noise(10 * kPieceBytes, 11));
  const auto [code, reason] = failure_of([&] { world.client().download(digest, 9 * kPieceBytes); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_EQ(world.server.got_pieces, 1u);
}

TEST_F(Client, AFileThatCannotBeWrittenIsAnErrorThatSaysWhy) {
  BlobWorld world;
  const Digest digest = world.server.put("abc");
  const auto [code, reason] = failure_of([&] { world.client().download(digest, folder / "none" / "blob"); });
  EXPECT_EQ(code, ExitCode::internal_error);
  EXPECT_THAT(reason, HasSubstr("No such file or directory"));
}

TEST_F(Client, ProgressGrowsToTheWhole) {
  BlobWorld world(kStorm);
  const std::vector<std::string> blobs = blobs_of_all_sizes();
  std::uint64_t last = 0, all = 0;
  const auto note = [&](std::uint64_t done, std::uint64_t whole) {
    EXPECT_GE(done, last);
    last = done, all = whole;
  };
  world.client().upload(sources_of(blobs), note);
  EXPECT_EQ(last, all);
  last = 0;
  world.client().download(sha256(blobs.back()), folder / "blob", note);
  EXPECT_EQ(last, blobs.back().size());
  EXPECT_EQ(all, blobs.back().size());
}

TEST_F(Client, ThousandsOfSmallBlobsShareTheRoad) {
  BlobWorld world({.seed = 1, .delay_min = Millis{10}, .delay_max = Millis{10}});
  std::vector<BlobSource> sources;
  for (unsigned i = 0; i < 3000; ++i) sources.push_back(blob_of(std::to_string(i)));
  sources.push_back(blob_of("7"));  // twice
  world.client().upload(sources);
  EXPECT_EQ(world.server.whole.size(), 3000u);
  EXPECT_EQ(world.server.put_pieces, 3000u);
  EXPECT_LT(world.now().time_since_epoch(), Millis{6000}) << "a window at a time, not one by one";
}

}  // namespace
}  // namespace tessera
