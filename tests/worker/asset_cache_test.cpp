// SPDX-License-Identifier: Apache-2.0
#include "worker/asset_cache.h"

#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

#include <atomic>
#include <fstream>
#include <map>
#include <thread>

#include "core/error.h"
#include "core/part_file.h"
#include "core/scene/bundle_scene.h"
#include "tests/core/scene/folder.h"
#include "tests/proto/blob_server.h"
#include "worker/bundle_source.h"
#include "worker/file_lock.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;

// Blobs by digest, as a coordinator has them, and how often each was fetched.
struct Origin {
  std::map<Digest, std::string> blobs;
  std::map<Digest, int> fetched;
  std::string fails;  // not empty: as a disk that is full

  Digest add(const std::string& bytes) {
    const Digest digest = sha256(bytes);
    blobs[digest] = bytes;
    return digest;
  }
  // Of files by path; the first is the scene.
  Digest add_bundle(const std::vector<std::pair<std::string, std::string>>& files) {
    Bundle bundle{files.front().first, {}};
    for (const auto& [path, bytes] : files) bundle.files.push_back({path, add(bytes), bytes.size()});
    std::ranges::sort(bundle.files, {}, &Bundle::File::path);
    return add(to_text(bundle));
  }
  FetchBlob fetch() {
    return [this](const Digest& digest, const fs::path& file) {
      if (!fails.empty()) throw Error(ExitCode::internal_error, fails);
      ++fetched[digest];
      std::ofstream(file, std::ios::binary) << blobs.at(digest);
    };
  }
  int times() const {
    int all = 0;
    for (const auto& [digest, n] : fetched) all += n;
    return all;
  }
};

class AssetCacheTest : public testing::Test {
 protected:
  Folder folder;
  Origin origin;

  AssetCache cache(std::uint64_t bytes = 1 << 20) const {
    return AssetCache({.folder = folder.path() / "cache", .bytes = bytes});
  }
  fs::path blob(const std::string& bytes) const { return folder.path() / "cache" / "blobs" / sha256(bytes); }
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

TEST_F(AssetCacheTest, LaysOutABundleAsAFolderAndFetchesEachFileOnce) {
  AssetCache one = cache();
  const Digest bundle =
      origin.add_bundle({{"a/s.json", "scene"}, {"b/c/x.png", "same"}, {"b/y.png", "same"}});
  const OpenBundle open = one.open(bundle, origin.fetch());
  EXPECT_EQ(contents(open.scene()), "scene");
  EXPECT_EQ(contents(open.files / "b/c/x.png"), "same");
  EXPECT_EQ(contents(open.files / "b/y.png"), "same");
  EXPECT_EQ(origin.times(), 3) << "two files and the manifest";
  EXPECT_EQ(fs::hard_link_count(blob("same")), 3u) << "links, not copies";
  one.open(bundle, origin.fetch());
  cache().open(bundle, origin.fetch());
  EXPECT_EQ(origin.times(), 3) << "nor is it fetched again by the next process";
}

TEST_F(AssetCacheTest, AnotherBundleFetchesOnlyWhatDiffers) {
  AssetCache one = cache();
  one.open(origin.add_bundle({{"s.json", "camera 1"}, {"mesh.obj", "large"}}), origin.fetch());
  origin.fetched.clear();
  one.open(origin.add_bundle({{"s.json", "camera 2"}, {"mesh.obj", "large"}}), origin.fetch());
  EXPECT_FALSE(origin.fetched.contains(sha256("large")));
  EXPECT_EQ(origin.times(), 2);
}

TEST_F(AssetCacheTest, FilesThatWereCutShortAreFetchedAgain) {
  AssetCache one = cache();
  const Digest bundle = origin.add_bundle({{"s.json", "scene"}, {"x.png", "pixels"}});
  fs::path files = one.open(bundle, origin.fetch()).files;
  fs::permissions(files / "x.png", fs::perms(0644));
  fs::resize_file(files / "x.png", 3);
  EXPECT_EQ(contents(one.open(bundle, origin.fetch()).files / "x.png"), "pixels");
  EXPECT_EQ(origin.fetched[sha256("pixels")], 2);
  fs::remove(files / "x.png");
  EXPECT_EQ(contents(one.open(bundle, origin.fetch()).files / "x.png"), "pixels");
  EXPECT_EQ(origin.fetched[sha256("pixels")], 2) << "the blob is still there";
}

TEST_F(AssetCacheTest, RepairFetchesFilesWhoseBytesAreWrongAndNoOthers) {
  AssetCache one = cache();
  const Digest bundle = origin.add_bundle({{"s.json", "scene"}, {"x.png", "pixels"}});
  const OpenBundle open = one.open(bundle, origin.fetch());
  EXPECT_EQ(one.repair(open, origin.fetch()), 0);
  fs::permissions(open.files / "x.png", fs::perms(0644));
  std::ofstream(open.files / "x.png", std::ios::binary) << "PIXELS";
  EXPECT_EQ(one.repair(open, origin.fetch()), 1);
  EXPECT_EQ(contents(open.files / "x.png"), "pixels");
  EXPECT_EQ(contents(blob("pixels")), "pixels");
  EXPECT_EQ(origin.fetched[sha256("scene")], 1);
}

TEST_F(AssetCacheTest, ADamagedManifestIsFetchedAgain) {
  const Digest bundle = origin.add_bundle({{"s.json", "scene"}});
  cache().open(bundle, origin.fetch());
  const fs::path manifest = folder.path() / "cache" / "bundles" / bundle / "manifest";
  fs::permissions(manifest, fs::perms(0644));
  std::ofstream(manifest, std::ios::binary) << "tessera bundle 1\n../../../etc/passwd\n";
  EXPECT_EQ(contents(cache().open(bundle, origin.fetch()).scene()), "scene");
}

TEST_F(AssetCacheTest, WhatIsNotUsedForTheLongestGoesFirst) {
  const std::string large(400, 'x');
  AssetCache one = cache(1500);
  const auto bundle_of = [&](const std::string& name) {
    return origin.add_bundle({{"s.json", large + name}});
  };
  const Digest a = bundle_of("a"), b = bundle_of("b"), c = bundle_of("c");
  one.open(a, origin.fetch());
  one.open(b, origin.fetch());
  one.open(a, origin.fetch());
  one.open(c, origin.fetch());
  origin.fetched.clear();
  one.open(a, origin.fetch());
  EXPECT_EQ(origin.times(), 0);
  one.open(b, origin.fetch());
  EXPECT_GT(origin.times(), 0);
}

TEST_F(AssetCacheTest, WhatIsInUseStaysAndTooMuchIsRefused) {
  const std::string large(700, 'x');
  AssetCache one = cache(1500);
  const Digest a = origin.add_bundle({{"s.json", large + "a"}}),
               b = origin.add_bundle({{"s.json", large + "b"}});
  auto held = std::make_unique<OpenBundle>(one.open(a, origin.fetch()));
  const auto [code, reason] = failure_of([&] { one.open(b, origin.fetch()); });
  EXPECT_EQ(code, ExitCode::internal_error);
  EXPECT_THAT(reason, HasSubstr("in use"));
  EXPECT_EQ(contents(held->scene()), large + "a");
  held.reset();
  EXPECT_EQ(contents(one.open(b, origin.fetch()).scene()), large + "b");
  EXPECT_FALSE(fs::exists(blob(large + "a")));
}

TEST_F(AssetCacheTest, AFullDiskIsNobodysBadInputAndCostsNothingElse) {
  AssetCache one = cache();
  const Digest bundle = origin.add_bundle({{"s.json", "scene"}});
  origin.fails = "blobs/x.part: cannot be written: No space left on device";
  const auto [code, reason] = failure_of([&] { one.open(bundle, origin.fetch()); });
  EXPECT_EQ(code, ExitCode::internal_error);
  EXPECT_THAT(reason, HasSubstr("No space left"));
  origin.fails.clear();
  EXPECT_EQ(contents(one.open(bundle, origin.fetch()).scene()), "scene");
}

TEST_F(AssetCacheTest, WhatIsNoBundleIsBadInput) {
  AssetCache one = cache();
  const Digest none = origin.add("tessera bundle 1\n../x\n" + sha256("") + " 0 ../x\n");
  const auto [code, reason] = failure_of([&] { one.open(none, origin.fetch()); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_THAT(reason, HasSubstr("'../x'"));
  EXPECT_FALSE(fs::exists(folder.path() / "cache" / "x"));
  const std::string scene = "scene";
  const Digest lying = origin.add("tessera bundle 1\ns\n" + origin.add(scene) + " 7 s\n");
  EXPECT_EQ(failure_of([&] { one.open(lying, origin.fetch()); }).first, ExitCode::bad_input);
}

TEST_F(AssetCacheTest, ManyThreadsAndCachesMayAskAtATime) {
  const std::string large(300, 'x');
  std::vector<Digest> bundles;
  for (int i = 0; i < 6; ++i)
    bundles.push_back(origin.add_bundle({{"s.json", large + std::to_string(i)}, {"c", "common"}}));
  std::atomic<int> good = 0;
  std::vector<std::jthread> threads;
  for (int t = 0; t < 4; ++t)
    threads.emplace_back([&, t] {
      AssetCache own = cache(2600);  // four bundles of about 600: some must go, none that is in use
      Origin mine = origin;
      for (int i = 0; i < 30; ++i) {
        const auto n = static_cast<std::size_t>(i * (t + 1) + t) % bundles.size();
        const FetchBlob fetch = [&](const Digest& digest, const fs::path& file) {
          PartFile part(file);  // others may take up what one of them has left
          part.append(std::string_view(mine.blobs.at(digest)).substr(part.size()));
          EXPECT_TRUE(part.commit(digest));
        };
        try {
          const OpenBundle open = own.open(bundles[n], fetch);
          if (contents(open.scene()) == large + std::to_string(n)) ++good;
        } catch (const Error& error) {
          ADD_FAILURE() << error.what();
        }
      }
    });
  threads.clear();
  EXPECT_EQ(good, 4 * 30);
}

TEST_F(AssetCacheTest, ALockHeldAloneExcludesAllOthers) {
  const fs::path file = folder.path() / "lock";
  auto shared = FileLock::shared(file), second = FileLock::shared(file);
  EXPECT_EQ(FileLock::alone(file), nullptr);
  shared.reset();
  EXPECT_EQ(FileLock::alone(file), nullptr);
  second.reset();
  EXPECT_NE(FileLock::alone(file), nullptr);
}

// --- Scenes over a road. ---

class FarmScenes : public testing::Test {
 protected:
  Folder folder;
  BlobWorld world{{.seed = 3, .loss = 0.1, .repeat = 0.1, .delay_max = Millis{10}}};
  int connections = 0;

  SceneSource source() {
    return scenes_of_farm(std::make_shared<AssetCache>(AssetCacheOptions{.folder = folder.path() / "cache"}),
                          [this] {
                            ++connections;
                            return std::make_unique<FarmClient>(world.client());
                          });
  }

  SceneRef handed_in() {
    const BundledScene scene = load_bundled(kData / "card.obj");
    std::vector<BlobSource> blobs{blob_of(to_text(scene.bundle))};
    for (std::size_t i = 0; i < scene.sources.size(); ++i)
      blobs.push_back(blob_of(scene.sources[i], scene.bundle.files[i].digest, scene.bundle.files[i].bytes));
    world.client().upload(blobs);
    return {scene.bundle.scene, content_hash(scene.scene), sha256(to_text(scene.bundle))};
  }
};

TEST_F(FarmScenes, ASceneIsTheSameOnTheOtherSideOfTheRoad) {
  const SceneRef ref = handed_in();
  EXPECT_EQ(content_hash(*source()(ref)), ref.hash);
  EXPECT_EQ(content_hash(*source()(ref)), ref.hash);
  EXPECT_EQ(connections, 1) << "the second time nothing was missing";
}

TEST_F(FarmScenes, AnotherSceneThanTheJobWasMadeForIsRefusedWithBothHashes) {
  SceneRef ref = handed_in();
  const std::string right = std::exchange(ref.hash, std::string(64, 'f'));
  const auto [code, reason] = failure_of([&] { source()(ref); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_THAT(reason, AllOf(HasSubstr(right), HasSubstr(ref.hash)));
}

TEST_F(FarmScenes, ADamagedCacheHealsItself) {
  const SceneRef ref = handed_in();
  source()(ref);
  const fs::path picture = folder.path() / "cache/bundles" / ref.bundle / "files/corners.png";
  std::string bytes = contents(picture);
  bytes[bytes.size() / 2] ^= 1;
  fs::permissions(picture, fs::perms(0644));
  std::ofstream(picture, std::ios::binary) << bytes;
  EXPECT_EQ(content_hash(*source()(ref)), ref.hash);
}

TEST_F(FarmScenes, FilesOfASceneStayForAsLongAsItLives) {
  const SceneRef ref = handed_in();
  auto scene = source()(ref);
  const fs::path lock = folder.path() / "cache/bundles" / (ref.bundle + ".lock");
  EXPECT_EQ(FileLock::alone(lock), nullptr);
  scene.reset();
  EXPECT_NE(FileLock::alone(lock), nullptr);
}

TEST_F(FarmScenes, ASceneWithoutABundleIsNotReadFromThisMachine) {
  const auto [code, reason] = failure_of([&] { source()({(kData / "card.obj").string(), "hash", ""}); });
  EXPECT_EQ(code, ExitCode::bad_input);
  EXPECT_THAT(reason, HasSubstr("not in a bundle"));
  EXPECT_EQ(connections, 0);
}

TEST_F(FarmScenes, ACoordinatorThatIsGoneIsUnreachableNotBadInput) {
  const SceneRef ref = handed_in();
  world.server.deaf = true;
  EXPECT_EQ(failure_of([&] { source()(ref); }).first, ExitCode::unreachable);
}

}  // namespace
}  // namespace tessera
