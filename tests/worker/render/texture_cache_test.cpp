// SPDX-License-Identifier: Apache-2.0
// Textures: where they lie, what memory they take, and what happens when files change.
#include "worker/render/texture_cache.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <optional>
#include <thread>

#include "tests/worker/render/chi_squared.h"
#include "tests/worker/render/textures.h"
#include "worker/render/texture_folder.h"

namespace tessera::tracer {
namespace {

namespace fs = std::filesystem;
using tessera::testing::Random;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using TextureCacheTest = TextureTest;

TEST_F(TextureCacheTest, WhatIsInMemoryChangesNoBit) {
  Random random(3);
  std::vector<float> pixels(1024 * 1024);
  for (float& v : pixels) v = random.number();
  for (int p = 0; p < 4; ++p) pixels[0] = static_cast<float>(p), add(1024, 1024, 1, pixels);
  const Textures roomy(scene_, cache()), tight(scene_, cache(0));
  struct Look {
    int picture;
    Vec2 uv;
    float width;
  };
  std::vector<Look> looks;
  for (int i = 0; i < 4000; ++i)
    looks.push_back({i % 4, {random.number(), random.number()}, i % 3 ? 3e-3f * random.number() : 0.0f});
  const auto seen = [](const Textures& textures, const Look& l) {
    return textures.lookup({.picture = l.picture}, l.uv, l.width);
  };
  std::vector<Texel> first, other(looks.size());
  for (const Look& l : looks) first.push_back(seen(roomy, l));
  {
    std::vector<std::jthread> team;
    for (std::size_t t = 0; t < 2; ++t)
      team.emplace_back([&, t] {
        for (std::size_t i = looks.size(); i-- > 0;)
          if (i % 2 == t) other[i] = seen(tight, looks[i]);
      });
  }
  EXPECT_EQ(first, other);
}

TEST_F(TextureCacheTest, MemoryStaysNearItsLimit) {
  std::vector<float> pixels(1024 * 1024);
  for (std::size_t i = 0; i < pixels.size(); ++i) pixels[i] = static_cast<float>(i % 1021);
  for (int p = 0; p < 12; ++p) pixels[0] = static_cast<float>(p), add(1024, 1024, 1, pixels);  // 48 MiB
  constexpr std::uint64_t kLimit = 16 << 20;
  for (const std::uint64_t limit : {kLimit, std::uint64_t{1} << 30}) {
    const auto shared = cache(limit);
    const Textures textures(scene_, shared);
    for (int p = 0; p < 12; ++p)
      for (int i = 0; i < 256; ++i)
        textures.lookup({.picture = p}, {(i % 16 + 0.5f) / 16, (i / 16 + 0.5f) / 16}, 0);
    if (limit == kLimit)
      EXPECT_LT(shared->memory_used(), kLimit + (1 << 20));
    else
      EXPECT_GT(shared->memory_used(), 2 * kLimit) << "there was something to leave out";
  }
}

TEST_F(TextureCacheTest, AFileThatChangesAfterLoadingIsAnError) {
  const auto file = folder_.write("wood.tga", targa(4, 4, [](int, int) { return 100; }));
  place(file);
  folder_.write("wood.tga", targa(4, 4, [](int, int) { return 101; }));
  const auto refusal = [&] {
    try {
      Textures(scene_, cache());
    } catch (const InputError& e) {
      return std::string(e.what());
    }
    return std::string("opened");
  };
  EXPECT_THAT(refusal(), HasSubstr("wood.tga: the image is not the one that was loaded"));
  fs::remove(file);
  EXPECT_THAT(refusal(), HasSubstr("wood.tga: no such file"));
  folder_.write("wood.tga", targa(4, 4, [](int, int) { return 100; }));
  EXPECT_EQ(refusal(), "opened");
  fs::remove(file);
  EXPECT_EQ(refusal(), "opened") << "what was converted is known by its content";
}

TEST_F(TextureCacheTest, AConvertedFileThatIsBrokenIsMadeAgain) {
  place(folder_.write("wood.tga", targa(4, 4, [](int, int) { return 255; })));
  { const Textures made(scene_, cache()); }
  const auto files = [&] {
    std::vector<fs::path> all;
    for (const auto& entry : fs::directory_iterator(folder_.path() / "cache")) all.push_back(entry.path());
    return all;
  };
  ASSERT_EQ(files().size(), 1u) << "and nothing half-written";
  fs::resize_file(files()[0], 40);
  EXPECT_NEAR(Textures(scene_, cache()).lookup({.picture = 0}, {0.5f, 0.5f}, 0)[0], 1, 1e-6f);
}

TEST_F(TextureCacheTest, ALookupThatFailsIsReportedAfterwards) {
  add(512, 512, 1, std::vector<float>(512 * 512, 1.0f));
  { const Textures made(scene_, cache()); }
  const auto file = fs::directory_iterator(folder_.path() / "cache")->path();
  fs::resize_file(file, fs::file_size(file) / 2);  // the header is whole
  const Textures textures(scene_, cache());
  for (int i = 0; i < 64; ++i) textures.lookup({.picture = 0}, {(i % 8 + 0.5f) / 8, (i / 8 + 0.5f) / 8}, 0);
  EXPECT_THROW(textures.require_sound(), Error);
}

TEST_F(TextureCacheTest, ProcessesMayConvertTheSamePictureAtTheSameTime) {
  place(folder_.write("wood.tga", targa(300, 200, [](int, int) { return 255; })));
  {
    std::vector<std::jthread> team;
    for (int t = 0; t < 4; ++t)
      team.emplace_back([&] {
        EXPECT_NEAR(Textures(scene_, cache()).lookup({.picture = 0}, {0.5f, 0.5f}, 0)[0], 1, 1e-6f);
      });
  }
  const fs::directory_iterator files(folder_.path() / "cache");
  EXPECT_EQ(std::distance(begin(files), end(files)), 1);
}

// Sets an environment variable for a while; null: takes it away.
class Variable {
 public:
  Variable(const char* name, const char* value) : name_(name) {
    if (const char* now = std::getenv(name)) before_ = now;
    set(value);
  }
  ~Variable() { set(before_ ? before_->c_str() : nullptr); }
  Variable(const Variable&) = delete;
  Variable& operator=(const Variable&) = delete;

 private:
  void set(const char* value) const { value ? setenv(name_, value, 1) : unsetenv(name_); }

  const char* name_;
  std::optional<std::string> before_;
};

TEST_F(TextureCacheTest, TheFolderIsTheOneAskedForThenThatOfTheEnvironmentThenTheUsersCache) {
  const fs::path home = folder_.path();
  const Variable xdg("XDG_CACHE_HOME", (home / "xdg").c_str());
  {
    const Variable ours("TESSERA_TEXTURE_CACHE", (home / "ours").c_str());
    EXPECT_EQ(TextureFolder(home / "asked").path(), home / "asked");
    EXPECT_EQ(TextureFolder({}).path(), home / "ours");
  }
  const Variable none("TESSERA_TEXTURE_CACHE", nullptr);
  EXPECT_EQ(TextureFolder({}).path(), home / "xdg/tessera/textures");
}

TEST_F(TextureCacheTest, AStandardFolderThatCannotBeWrittenGivesATemporaryOneAndAWarning) {
  const Variable none("TESSERA_TEXTURE_CACHE", nullptr);
  const Variable xdg("XDG_CACHE_HOME", folder_.write("file", "").c_str());
  fs::path path;
  {
    const TextureFolder folder({});
    path = folder.path();
    EXPECT_TRUE(fs::is_directory(path));
    EXPECT_THAT(folder.warning(), HasSubstr("file/tessera/textures': "));
  }
  EXPECT_FALSE(fs::exists(path));
}

TEST_F(TextureCacheTest, AFolderThatWasAskedForHasToBeUsable) {
  const auto file = folder_.write("file", "");
  TextureCache bad(TextureOptions{.folder = file / "below"});
  EXPECT_THROW(bad.warning(), Error);
  TextureCache good(TextureOptions{.folder = folder_.path() / "a/b"});
  EXPECT_THAT(good.warning(), IsEmpty());
}

}  // namespace
}  // namespace tessera::tracer
