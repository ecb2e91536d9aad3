// SPDX-License-Identifier: Apache-2.0
#include "coordinator/store/blob_store.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <limits>

#include "coordinator/store/error.h"
#include "coordinator/store/kept_image.h"
#include "tests/coordinator/store/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;
using testing::ThrowsMessage;

constexpr std::int64_t kEver = std::numeric_limits<std::int64_t>::max();

std::string some_bytes(std::size_t count) {
  std::string bytes(count, '\0');
  for (std::size_t i = 0; i < count; ++i) bytes[i] = static_cast<char>(i * 31 + i / 251);
  return bytes;
}

void write_file(const fs::path& file, std::string_view bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

TEST(BlobStore, GivesBackWhatWasPutUnderItsDigest) {
  Folder folder;
  BlobStore store(folder.path());
  const std::string bytes = some_bytes(3'000'000);
  const Digest blob = store.put(bytes);
  EXPECT_EQ(blob, sha256(bytes));
  EXPECT_TRUE(store.has(blob));
  EXPECT_EQ(store.size(blob), bytes.size());
  EXPECT_EQ(store.read(blob), bytes);
  EXPECT_EQ(store.read_piece(blob, 2'999'990, 100), bytes.substr(2'999'990));
  EXPECT_EQ(store.read_piece(blob, 3'000'000, 100), "");
  EXPECT_THROW(store.read_piece(blob, 3'000'001, 1), InputError);
  EXPECT_EQ(store.put(bytes), blob);
  EXPECT_EQ(store.bytes(), bytes.size());
  EXPECT_EQ(store.read(store.put("")), "");
}

TEST(BlobStore, ABlobThatIsNotThereIsAnErrorAndANameThatIsNoDigestIsRefused) {
  Folder folder;
  BlobStore store(folder.path());
  const Digest none(64, 'a');
  EXPECT_FALSE(store.has(none));
  EXPECT_THROW(store.read(none), StoreError);
  EXPECT_THROW(store.size(none), StoreError);
  for (const char* name : {"", "../../etc/passwd", "AB"}) EXPECT_THROW(store.known(name), InputError);
  EXPECT_THROW(store.take_piece("../" + none, 1, 0, "x"), InputError);
}

TEST(BlobStore, TakesAFileAway) {
  Folder folder;
  BlobStore store(folder.path() / "store");
  const std::string bytes = some_bytes(100'000);
  for (int times = 0; times < 2; ++times) {
    write_file(folder.path() / "picture", bytes);
    const fs::path file = folder.path() / "picture";
    EXPECT_EQ(sealed(file, true), sha256(bytes));
    store.put_file(file, sha256(bytes));
    EXPECT_FALSE(fs::exists(folder.path() / "picture"));
  }
  EXPECT_EQ(store.read(sha256(bytes)), bytes);
  EXPECT_EQ(store.bytes(), bytes.size());
}

TEST(BlobStore, TakesAFileOfAnotherFileSystem) {
  if (!fs::is_directory("/dev/shm")) GTEST_SKIP() << "there is no other file system";
  Folder folder;
  BlobStore store(folder.path());
  const std::string bytes = some_bytes(2'500'000);
  const fs::path file = fs::path("/dev/shm") / folder.path().filename();
  write_file(file, bytes);
  const Digest blob = sealed(file, true);
  store.put_file(file, blob);
  EXPECT_EQ(store.read(blob), bytes);
  EXPECT_FALSE(fs::exists(file));
}

TEST(BlobStore, PiecesMakeABlobWhicheverOfThemComeTwiceOrTooEarly) {
  Folder folder;
  BlobStore store(folder.path());
  const std::string bytes = some_bytes(1000);
  const Digest blob = sha256(bytes);
  const auto piece = [&](std::size_t from, std::size_t count) {
    return store.take_piece(blob, bytes.size(), from, std::string_view(bytes).substr(from, count));
  };
  EXPECT_EQ(piece(300, 300), 0u);
  EXPECT_EQ(piece(0, 300), 300u);
  EXPECT_EQ(piece(0, 300), 300u);
  EXPECT_EQ(store.known(blob).have, 300u);
  EXPECT_FALSE(store.known(blob).whole);
  EXPECT_FALSE(store.has(blob));
  EXPECT_EQ(piece(600, 400), 300u);
  EXPECT_EQ(piece(300, 300), 600u);
  EXPECT_EQ(piece(600, 400), 1000u);
  EXPECT_TRUE(store.known(blob).whole);
  EXPECT_EQ(piece(600, 400), 1000u);
  EXPECT_EQ(store.read(blob), bytes);
  EXPECT_EQ(store.bytes(), 1000u);
  EXPECT_TRUE(fs::is_empty(folder.path() / "uploads"));
}

TEST(BlobStore, AnUploadGoesOnAByteBeforeWhereItWasWhenTheStoreWasClosed) {
  Folder folder;
  const std::string bytes = some_bytes(5000);
  const Digest blob = sha256(bytes);
  for (std::size_t at = 0; at < bytes.size(); at += 999) {
    BlobStore store(folder.path());
    ASSERT_EQ(store.known(blob).have, at);
    EXPECT_EQ(store.bytes(), at);
    store.take_piece(blob, bytes.size(), at, std::string_view(bytes).substr(at, 1000));
  }
  EXPECT_EQ(BlobStore(folder.path()).read(blob), bytes);
}

TEST(BlobStore, AnUploadOfWhichAllCameButThatWasNotFoundWholeLacksSomething) {
  Folder folder;
  { BlobStore store(folder.path()); }
  const std::string bytes = some_bytes(5000);
  const Digest blob = sha256(bytes);
  write_file(folder.path() / "uploads" / blob, bytes);
  BlobStore store(folder.path());
  const std::uint64_t have = store.known(blob).have;
  EXPECT_LT(have, bytes.size());
  EXPECT_EQ(store.take_piece(blob, bytes.size(), have, std::string_view(bytes).substr(have)), bytes.size());
  EXPECT_EQ(store.read(blob), bytes);
}

TEST(BlobStore, PiecesOfSomethingElseAreThrownAwayAndThatIsSaid) {
  Folder folder;
  BlobStore store(folder.path());
  const Digest blob = sha256("right");
  store.take_piece(blob, 5, 0, "wr");
  EXPECT_THAT([&] { store.take_piece(blob, 5, 2, "ong"); }, ThrowsMessage<InputError>(HasSubstr("digest")));
  EXPECT_EQ(store.known(blob).have, 0u);
  EXPECT_EQ(store.bytes(), 0u);
  EXPECT_EQ(store.take_piece(blob, 5, 0, "right"), 5u);
  EXPECT_TRUE(store.has(blob));
}

TEST(BlobStore, APieceOutsideItsBlobIsRefused) {
  Folder folder;
  BlobStore store(folder.path());
  const Digest blob = sha256("right");
  EXPECT_THROW(store.take_piece(blob, 5, 0, "rights"), InputError);
  EXPECT_THROW(store.take_piece(blob, 5, 6, ""), InputError);
  EXPECT_THROW(store.take_piece(blob, 5, std::numeric_limits<std::uint64_t>::max(), "r"), InputError);
  EXPECT_THROW(store.take_piece(blob, std::numeric_limits<std::uint64_t>::max(), 0, "r"), InputError);
}

TEST(BlobStore, AnUploadThatIsLongerThanItsSizeIsThrownAway) {
  Folder folder;
  BlobStore store(folder.path());
  const Digest blob = sha256("right");
  store.take_piece(blob, 100, 0, "right and more");
  EXPECT_THROW(store.take_piece(blob, 5, 0, "right"), InputError);
  EXPECT_EQ(store.known(blob).have, 0u);
}

TEST(BlobStore, ADamagedBlobIsFoundWhenItIsReadAndCanBeBroughtAgain) {
  Folder folder;
  BlobStore store(folder.path());
  const std::string bytes = some_bytes(4096);
  const Digest blob = store.put(bytes);
  std::string damaged = bytes;
  damaged[1234] ^= 1;
  write_file(store.path(blob), damaged);
  EXPECT_THROW(store.read(blob), StoreDamaged);
  EXPECT_FALSE(store.has(blob));
  EXPECT_TRUE(fs::exists(folder.path() / "damaged" / blob));
  EXPECT_EQ(store.put(bytes), blob);
  EXPECT_EQ(store.read(blob), bytes);
  write_file(store.path(blob), bytes.substr(1));
  EXPECT_EQ(store.put(bytes), blob) << "a blob of another length";
  EXPECT_EQ(store.read(blob), bytes);
}

TEST(BlobStore, KeepsWithinItsLimit) {
  Folder folder;
  BlobStore store(folder.path(), {.most = 1000});
  const Digest first = store.put(some_bytes(600));
  EXPECT_THROW(store.put(some_bytes(401)), StoreFull);
  const std::string bytes = some_bytes(500);
  EXPECT_THROW(store.take_piece(sha256(bytes), 500, 0, bytes.substr(0, 10)), StoreFull) << "begun in vain";
  EXPECT_EQ(store.bytes(), 600u);
  store.put(some_bytes(400));
  EXPECT_EQ(store.bytes(), 1000u);
  EXPECT_EQ(store.remove_unreferenced({first}, kEver), 400u);
  store.put(some_bytes(300));
}

TEST(BlobStore, RemovesWhatNobodyRefersToUnlessItWasUsedLately) {
  Folder folder;
  BlobStore store(folder.path());
  const Digest kept = store.put("kept"), gone = store.put("gone");
  store.take_piece(sha256("begun"), 5, 0, "beg");
  EXPECT_EQ(store.remove_unreferenced({kept}, 1'000'000), 0u) << "all are younger";
  EXPECT_TRUE(store.has(gone));
  EXPECT_EQ(store.remove_unreferenced({kept}, kEver), 7u);
  EXPECT_TRUE(store.has(kept));
  EXPECT_FALSE(store.has(gone));
  EXPECT_EQ(store.known(sha256("begun")).have, 0u);
  EXPECT_EQ(store.bytes(), 4u);
}

TEST(BlobStore, WhatWasBeingWrittenWhenTheProcessEndedIsGone) {
  Folder folder;
  {
    BlobStore store(folder.path());
    store.put("whole");
  }
  const fs::path half = folder.path() / "blobs" / "ab" / "cdef.tmp-0123456789abcdef";
  fs::create_directories(half.parent_path());
  write_file(half, "half");
  BlobStore store(folder.path());
  EXPECT_FALSE(fs::exists(half));
  EXPECT_EQ(store.bytes(), 5u);
}

TEST(KeptImage, IsTheSameBitsAndADamagedOneIsRefused) {
  Folder folder;
  BlobStore store(folder.path());
  Image image({3, 5, 40, 30}, 4);
  std::uint32_t bits = 0x7fc00001;  // a NaN, with a payload
  for (float& v : image.data()) {
    std::memcpy(&v, &bits, sizeof v);
    bits = bits * 1664525 + 1013904223;
  }
  const Digest blob = put_image(store, image);
  EXPECT_TRUE(same_bits(get_image(store, blob), image));
  std::string bytes = store.read(blob);
  bytes.back() ^= 1;
  write_file(store.path(blob), bytes);
  EXPECT_THROW(get_image(store, blob), StoreDamaged);
  EXPECT_THROW(get_image(store, store.put("no image at all")), Error);
}

}  // namespace
}  // namespace tessera
