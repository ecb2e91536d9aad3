// SPDX-License-Identifier: Apache-2.0
#include "core/scene/bundle_scene.h"

#include <gmock/gmock.h>

#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;

const std::string kPly =
    "ply\nformat ascii 1.0\ncomment TextureFile corners.png\nelement vertex 3\nproperty float x\n"
    "property float y\nproperty float z\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
const std::string kBall = R"({"spheres": [{"center": [0, 0, 0]}]})";

class BundledSceneTest : public testing::Test {
 protected:
  Folder folder;

  fs::path put(const std::string& path, const std::string& bytes) const {
    fs::create_directories((folder.path() / path).parent_path());
    return folder.write(path, bytes);
  }
  void put_data(const std::string& name, const std::string& path) const { put(path, contents(kData / name)); }

  static std::vector<std::string> paths(const Bundle& bundle) {
    std::vector<std::string> all;
    for (const Bundle::File& file : bundle.files) all.push_back(file.path);
    return all;
  }

  // The bundle's files, and nothing else, in a folder of their own; the scene file there.
  fs::path unpacked(const BundledScene& from) const {
    const fs::path to = folder.path() / "unpacked";
    fs::remove_all(to);
    for (std::size_t i = 0; i < from.sources.size(); ++i) {
      const fs::path file = to / from.bundle.files[i].path;
      fs::create_directories(file.parent_path());
      fs::copy_file(from.sources[i], file);
      EXPECT_EQ(sha256(contents(file)), from.bundle.files[i].digest);
      EXPECT_EQ(fs::file_size(file), from.bundle.files[i].bytes);
    }
    return to / from.bundle.scene;
  }

  // The hash of what the unpacked scene loads as, where nothing else may be read.
  std::string hash_elsewhere(const BundledScene& from) const {
    ImportLimits limits;
    const fs::path scene = unpacked(from);
    limits.roots = {folder.path() / "unpacked"};
    return content_hash(load_scene(scene, limits));
  }

  static std::string refusal_of(const fs::path& scene, const std::vector<fs::path>& roots = {}) {
    try {
      load_bundled(scene, roots);
    } catch (const InputError& error) {
      return error.what();
    }
    return "bundled";
  }
};

TEST_F(BundledSceneTest, HasWhatIsReadForAFileOfEveryFormatAndNothingElse) {
  put_data("card.obj", "models/card.obj");
  put_data("card.mtl", "models/card.mtl");
  put_data("corners.png", "models/corners.png");
  put_data("card.gltf", "gltf/card.gltf");
  put_data("corners.png", "gltf/corners.png");
  put("ply/tri.ply", kPly);
  put_data("corners.png", "ply/corners.png");
  put_data("corners.png", "tex/a.1001.png");
  put_data("corners.png", "tex/a.1012.png");
  put_data("corners.png", "tex/sky.png");
  put_data("corners.png", "tex/unused.png");
  put("inner/part.json", R"({"import": [{"file": "../ply/tri.ply"}]})");
  put("readme.txt", "not of the scene");
  const fs::path file = put("s.json", R"({
    "import": [{"file": "models/card.obj"}, {"file": "gltf/card.gltf"}, {"file": "inner/part.json"},
               {"file": "models/../models/card.obj"}],
    "environment": {"image": "tex/sky.png"},
    "materials": {"m": {"color_texture": {"file": "tex/a.<UDIM>.png"}}}})");
  const BundledScene all = load_bundled(file);
  EXPECT_EQ(all.bundle.scene, "s.json");
  EXPECT_THAT(paths(all.bundle),
              ElementsAre("gltf/card.gltf", "gltf/corners.png", "inner/part.json", "models/card.mtl",
                          "models/card.obj", "models/corners.png", "ply/corners.png", "ply/tri.ply", "s.json",
                          "tex/a.1001.png", "tex/a.1012.png", "tex/sky.png"));
  EXPECT_EQ(content_hash(all.scene), content_hash(load_scene(file)));
  EXPECT_EQ(hash_elsewhere(all), content_hash(all.scene));
}

TEST_F(BundledSceneTest, BuffersOfAGltfAreOfIt) {
  const fs::path file =
      put("a.gltf", R"({"asset": {"version": "2.0"}, "buffers": [{"uri": "buf/x%20y.bin", "byteLength": 36}],
    "bufferViews": [{"buffer": 0, "byteLength": 36}], "accessors": [{"bufferView": 0, "componentType": 5126,
    "count": 3, "type": "VEC3"}], "meshes": [{"primitives": [{"attributes": {"POSITION": 0}}]}],
    "nodes": [{"mesh": 0}], "scenes": [{"nodes": [0]}], "scene": 0})");
  put("buf/x y.bin", std::string(36, '\0'));
  const BundledScene all = load_bundled(file);
  EXPECT_THAT(paths(all.bundle), ElementsAre("a.gltf", "buf/x y.bin"));
  EXPECT_EQ(hash_elsewhere(all), content_hash(all.scene));
}

TEST_F(BundledSceneTest, FilesOfOtherRootsKeepTheirPlacesBelowTheCommonFolder) {
  put("lib/models/ball.json", kBall);
  const fs::path file = put("shots/a/s.json", R"({"import": [{"file": "../../lib/models/ball.json"}]})");
  EXPECT_THAT(refusal_of(file), AllOf(HasSubstr("lib/models/ball.json"), HasSubstr("outside"),
                                      HasSubstr((folder.path() / "shots/a").string())));
  const BundledScene all = load_bundled(file, {folder.path() / "lib"});
  EXPECT_EQ(all.bundle.scene, "shots/a/s.json");
  EXPECT_THAT(paths(all.bundle), ElementsAre("lib/models/ball.json", "shots/a/s.json"));
  EXPECT_EQ(hash_elsewhere(all), content_hash(all.scene));
}

TEST_F(BundledSceneTest, LinksThatLeadOutsideAreRefused) {
  put("outside/ball.json", kBall);
  const fs::path file = put("in/s.json", R"({"import": [{"file": "ball.json"}]})");
  fs::create_symlink("../outside/ball.json", folder.path() / "in/ball.json");
  EXPECT_THAT(refusal_of(file), AllOf(HasSubstr("in/ball.json"), HasSubstr("link")));
  fs::remove(folder.path() / "in/ball.json");
  put("in/s.json", R"({"import": [{"file": "sub/ball.json"}]})");
  fs::create_directory_symlink("../outside", folder.path() / "in/sub");
  EXPECT_THAT(refusal_of(file), AllOf(HasSubstr("in/sub/ball.json"), HasSubstr("link")));
  EXPECT_EQ(refusal_of(file, {folder.path() / "outside"}), "bundled");
}

TEST_F(BundledSceneTest, LinksWithinAreBundledUnderTheirOwnNames) {
  put("real/ball.json", kBall);
  const fs::path file = put("s.json", R"({"import": [{"file": "link.json"}]})");
  fs::create_symlink("real/ball.json", folder.path() / "link.json");
  const BundledScene all = load_bundled(file);
  EXPECT_THAT(paths(all.bundle), ElementsAre("link.json", "s.json"));
  EXPECT_EQ(hash_elsewhere(all), content_hash(all.scene));
}

TEST_F(BundledSceneTest, TilesThatAreLinksToTheOutsideAreRefused) {
  put_data("corners.png", "outside/a.png");
  const fs::path file =
      put("in/s.json", R"({"materials": {"m": {"color_texture": {"file": "a.<UDIM>.png"}}}})");
  fs::create_symlink("../outside/a.png", folder.path() / "in/a.1001.png");
  EXPECT_THAT(refusal_of(file), HasSubstr("in/a.1001.png"));
}

TEST_F(BundledSceneTest, LibrariesOfModelsOutsideAreRefused) {
  put("outside/card.mtl", "newmtl paper\n");
  std::string obj = contents(kData / "card.obj");
  obj.replace(obj.find("card.mtl"), 8, "../outside/card.mtl");
  const fs::path file = put("in/card.obj", obj);
  EXPECT_THAT(refusal_of(file), HasSubstr("outside/card.mtl"));
}

TEST_F(BundledSceneTest, AbsolutePathsAreRefusedWithWhatIsAccepted) {
  const fs::path ball = put("ball.json", kBall);
  const fs::path file = put("s.json", R"({"import": [{"file": ")" + ball.string() + R"("}]})");
  EXPECT_THAT(refusal_of(file), AllOf(HasSubstr(ball.string() + ": "), HasSubstr("absolute path"),
                                      HasSubstr("accepted: paths relative")));
}

TEST_F(BundledSceneTest, AnotherCameraChangesTheSceneFileAlone) {
  put_data("card.obj", "card.obj");
  put_data("card.mtl", "card.mtl");
  put_data("corners.png", "corners.png");
  const std::string text =
      R"({"import": [{"file": "card.obj"}], "camera": {"look_at": {"from": [0, 1, 8], "to": [0, 1, 0]}}})";
  const Bundle before = load_bundled(put("s.json", text)).bundle;
  EXPECT_EQ(load_bundled(put("s.json", text)).bundle, before);
  std::string other = text;
  other.replace(other.find("8]"), 1, "9");
  const Bundle after = load_bundled(put("s.json", other)).bundle;
  ASSERT_EQ(after.files.size(), before.files.size());
  for (std::size_t i = 0; i < after.files.size(); ++i)
    EXPECT_EQ(after.files[i].digest == before.files[i].digest, after.files[i].path != "s.json");
}

TEST_F(BundledSceneTest, ASceneFromElsewhereReadsNothingOutsideOfItsFolder) {
  const fs::path secret = put("secret.png", contents(kData / "corners.png"));
  put("box/inside.png", contents(kData / "corners.png"));
  ImportLimits limits;
  limits.roots = {folder.path() / "box"};
  const auto load = [&](const std::string& picture) {
    const fs::path file =
        put("box/s.json", R"({"materials": {"m": {"color_texture": {"file": ")" + picture + R"("}}}})");
    try {
      load_scene(file, limits);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string("loaded");
  };
  EXPECT_EQ(load("inside.png"), "loaded");
  EXPECT_EQ(load("no-such-folder/../inside.png"), "loaded") << "names are taken by their text";
  EXPECT_THAT(load("../secret.png"), HasSubstr("outside"));
  EXPECT_THAT(load(secret.string()), HasSubstr("outside"));
  EXPECT_THAT(load("../box-2/secret.png"), HasSubstr("outside"));
  EXPECT_THAT(load("../<UDIM>.png"), HasSubstr("outside"));
}

TEST_F(BundledSceneTest, TheSceneFileIsTheFirstOfItsFilesEachOnce) {
  put("ball.json", kBall);
  const fs::path file = put("s.json", R"({"import": [{"file": "ball.json"}, {"file": "ball.json"}]})");
  EXPECT_THAT(load_scene(file).files, ElementsAre(file.string(), (folder.path() / "ball.json").string()));
}

}  // namespace
}  // namespace tessera
