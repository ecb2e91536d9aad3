// SPDX-License-Identifier: Apache-2.0
// A converted scene is the same scene: its hash says so.
#include "core/scene/convert.h"

#include <gmock/gmock.h>

#include "core/scene/json_text.h"
#include "core/scene/native/write.h"
#include "tests/core/scene/folder.h"
#include "tests/core/scene/glb.h"

namespace tessera {
namespace {

class Converted : public testing::Test {
 protected:
  // Converts, and loads what came out on its own.
  bool is_whole(const std::filesystem::path& from) {
    const std::filesystem::path to = folder_.path() / "out.json";
    const Conversion conversion = convert_scene(from, to);
    EXPECT_EQ(content_hash(load_scene(to)), content_hash(load_scene(from))) << from;
    EXPECT_EQ(conversion.whole, conversion.why_not.empty());
    return conversion.whole;
  }
  std::size_t files() const {
    return static_cast<std::size_t>(std::distance(std::filesystem::directory_iterator(folder_.path()),
                                                  std::filesystem::directory_iterator()));
  }
  const Folder folder_;
};

TEST_F(Converted, NativeScenesAreWhole) {
  EXPECT_TRUE(is_whole(kData / "full.json"));
  EXPECT_TRUE(is_whole(kData / "../../../scenes/cornell.json"));
  EXPECT_TRUE(is_whole(kData / "../../../scenes/furnace.json"));
  EXPECT_EQ(files(), 1u) << "no drafts are left";
}

TEST_F(Converted, AConvertedSceneConvertsToItself) {
  convert_scene(kData / "full.json", folder_.path() / "a.json");
  std::filesystem::create_directory(folder_.path() / "b");
  convert_scene(folder_.path() / "a.json", folder_.path() / "b.json");
  std::filesystem::remove(folder_.path() / "b");
  EXPECT_EQ(contents(folder_.path() / "a.json"), contents(folder_.path() / "b.json"));
}

TEST_F(Converted, ModelsAreWholeIfTheyAreSmall) {
  EXPECT_TRUE(is_whole(kData / "card.obj"));
  EXPECT_TRUE(is_whole(kData / "card.gltf"));
}

TEST_F(Converted, EmbeddedPicturesAreImportedWithTheFile) {
  const auto glb = folder_.write("plain.glb", glb_with_embedded_image());
  EXPECT_FALSE(is_whole(glb));
  EXPECT_THAT(contents(folder_.path() / "out.json"), testing::HasSubstr(R"("file": "plain.glb")"));
  EXPECT_FALSE(is_whole(kData / "all.json"));
}

TEST_F(Converted, LargeMeshesAreImportedWithTheFile) {
  std::string obj;
  for (std::size_t v = 0; v <= kMaxInlineVertices; ++v)
    obj += "v " + std::to_string(v) + " 0 0\nv 0 1 0\nv 0 0 1\n";
  for (std::size_t v = 0; v <= kMaxInlineVertices; ++v)
    obj += "f " + std::to_string(3 * v + 1) + " " + std::to_string(3 * v + 2) + " " +
           std::to_string(3 * v + 3) + "\n";
  EXPECT_FALSE(is_whole(folder_.write("large.obj", obj)));
}

TEST_F(Converted, NothingIsWrittenIfTheSceneIsBadOrTheNameIs) {
  const auto bad = folder_.write("bad.json", R"({"camra": {}})");
  EXPECT_THROW(convert_scene(bad, folder_.path() / "out.json"), InputError);
  EXPECT_THROW(convert_scene(kData / "full.json", folder_.path() / "out.txt"), Error);
  const auto good = folder_.write("good.json", R"({"spheres": [{"center": [0, 0, 0]}]})");
  EXPECT_THROW(convert_scene(good, good), Error);
  EXPECT_EQ(files(), 2u);
}

TEST(JsonText, NumbersReadBackAsTheSameFloat) {
  for (std::uint32_t i = 1; i < 50'000; ++i) {
    const std::uint32_t bits = i * 0x9E3779B1u;  // all over the floats
    float f;
    std::memcpy(&f, &bits, 4);
    if (!std::isfinite(f)) continue;
    const Json back = parse_json(json_text(Json{static_cast<double>(f)}), "f");
    const float g = static_cast<float>(back.number());
    ASSERT_EQ(std::memcmp(&f, &g, 4), 0) << f;
  }
}

TEST(JsonText, ReadsBackWhateverTheNamesAre) {
  Json::Object object;
  object.push_back({"a\"\\\n\x01\xc3\xa4", Json{-0.0}});
  object.push_back({"", Json{Json::Array{}}});
  object.push_back({"deep", Json{Json::Array{Json{std::string(200, 'x')}, Json{nullptr}, Json{true}}}});
  const Json back = parse_json(json_text(Json{object}), "f");
  ASSERT_EQ(back.members().size(), 3u);
  EXPECT_EQ(back.members()[0].first, object[0].first);
  EXPECT_TRUE(std::signbit(back.members()[0].second.number()));
  EXPECT_EQ(back.find("deep")->items()[0].text(), std::string(200, 'x'));
}

}  // namespace
}  // namespace tessera
