// SPDX-License-Identifier: Apache-2.0
// Files with some bytes changed, cut or repeated: each loads or is refused with an InputError, nothing else.
#include <gtest/gtest.h>

#include <random>

#include "core/scene/pictures.h"
#include "tests/core/scene/compressed.h"
#include "tests/core/scene/glb.h"
#include "tests/core/scene/models.h"

// assimp and OpenImageIO (where libpng jumps out of it) forget memory when a file is broken. Not ours to
// mend; ours would still be found.
extern "C" const char* __asan_default_options();
extern "C" const char* __asan_default_options() {
  return "fast_unwind_on_malloc=0";
}  // sees through libstdc++
extern "C" const char* __lsan_default_suppressions();
extern "C" const char* __lsan_default_suppressions() {
  return "leak:libassimp\nleak:libOpenImageIO\nleak:libpng\n";
}

namespace tessera {
namespace {

std::string spoilt(std::string bytes, std::mt19937& random) {
  static const std::string odd = "\"{}[],:-0129eE.#\n \\/\0\xff\x80\x01nN";
  const auto somewhere = [&] { return random() % bytes.size(); };
  for (unsigned n = 1 + random() % 3; n > 0 && !bytes.empty(); --n) {
    switch (random() % 6) {
      case 0:
        bytes[somewhere()] = static_cast<char>(random());
        break;
      case 1:
        bytes[somewhere()] ^= static_cast<char>(1u << random() % 8);
        break;
      case 2:
        bytes[somewhere()] = odd[random() % odd.size()];
        break;
      case 3:
        bytes.erase(somewhere(), 1 + random() % 8);
        break;
      case 4:
        bytes.resize(somewhere());
        break;
      default:
        bytes.insert(somewhere(), bytes.substr(somewhere(), 1 + random() % 16));
    }
  }
  return bytes;
}

// Everything that glTF stores in lists: instances, sparse elements, strips, colours, tracks, variants.
GltfBuilder moving_square() {
  GltfBuilder built;
  const int square = built.square();
  const int places = built.view(GltfBuilder::bytes_of<std::uint16_t>({1})),
            values = built.view(GltfBuilder::bytes_of<float>({2, 0, 0}));
  built.json["accessors"][0]["sparse"] = {{"count", 1},
                                          {"indices", {{"bufferView", places}, {"componentType", 5123}}},
                                          {"values", {{"bufferView", values}}}};
  const int colors = built.accessor<std::uint8_t>(std::vector<std::uint8_t>(16, 99), "VEC4", true);
  const nlohmann::json variants = {{"mappings", {{{"material", 0}, {"variants", {0}}}}}};
  const int mesh = built.mesh({{"attributes", {{"POSITION", square}, {"COLOR_0", colors}}},
                               {"mode", 6},
                               {"extensions", {{"KHR_materials_variants", variants}}}});
  built.json["materials"] = {{{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatFactor", 1}}}}}}};
  built.json["extensions"]["KHR_materials_variants"]["variants"] = {{{"name", "v"}}};
  const nlohmann::json copies = {{"TRANSLATION", built.accessor<float>({0, 0, 0, 1, 1, 1}, "VEC3")}};
  built.json["nodes"] = {
      {{"mesh", mesh}, {"extensions", {{"EXT_mesh_gpu_instancing", {{"attributes", copies}}}}}}};
  const int times = built.accessor<float>({0, 1}, "SCALAR"),
            turns = built.accessor<float>({0, 0, 0, 1, 0, 1, 0, 0}, "VEC4");
  built.json["animations"] = {
      {{"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "rotation"}}}}}},
       {"samplers", {{{"input", times}, {"output", turns}, {"interpolation", "LINEAR"}}}}}};
  return built;
}

struct Kind {
  std::string name;
  int rounds;
};

void PrintTo(const Kind& kind, std::ostream* os) { *os << kind.name; }

class SpoiltFile : public testing::TestWithParam<Kind> {
 protected:
  SpoiltFile() {
    for (const char* name : {"corners.png", "card.mtl", "card.obj", "card.gltf"})
      folder_.write(name, contents(kData / name));
    folder_.write("all.json", contents(kData / "all.json"));
    folder_.write("plain.glb", glb_with_embedded_image());
    folder_.write("card.glb", glb_of(contents(kData / "card.gltf"), {}));
    folder_.write("text.ply", kTextPly);
    folder_.write("binary.ply", binary_ply());
    folder_.write("text.fbx", kTextFbx);
    folder_.write("binary.fbx", binary_fbx());
    folder_.write("meshopt.glb", meshopt_square().bytes());
    folder_.write("draco.glb", draco_square().bytes());
    folder_.write("moving.glb", moving_square().bytes());
    folder_.write("textured.json", R"({"environment": {"image": "corners.png"}})");
  }
  const Folder folder_;
};

TEST_P(SpoiltFile, LoadsOrIsRefusedInWords) {
  const std::string name = GetParam().name;
  const std::string good = contents(folder_.path() / name);
  const std::string scene = name == "corners.png" ? "textured.json" : name == "card.mtl" ? "card.obj" : name;
  ASSERT_FALSE(load_scene(folder_.path() / scene).cameras.empty());
  for (int seed = 0; seed < GetParam().rounds; ++seed) {
    std::mt19937 random(static_cast<unsigned>(seed));
    folder_.write(name, spoilt(good, random));
    try {
      load_scene(folder_.path() / scene);
    } catch (const InputError&) {
    } catch (const std::exception& e) {
      FAIL() << "seed " << seed << ": " << e.what();
    }
  }
}

INSTANTIATE_TEST_SUITE_P(Scenes, SpoiltFile,
                         testing::Values(Kind{"all.json", 500}, Kind{"card.gltf", 1000},
                                         Kind{"card.glb", 1000}, Kind{"plain.glb", 1000},
                                         Kind{"card.obj", 1500}, Kind{"card.mtl", 1000},
                                         Kind{"text.ply", 300}, Kind{"binary.ply", 500},
                                         Kind{"text.fbx", 300}, Kind{"binary.fbx", 500},
                                         Kind{"meshopt.glb", 500}, Kind{"draco.glb", 500},
                                         Kind{"moving.glb", 500}, Kind{"corners.png", 1000}),
                         [](const auto& test) {
                           std::string name = test.param.name;
                           name[name.find('.')] = '_';
                           return name;
                         });

}  // namespace
}  // namespace tessera
