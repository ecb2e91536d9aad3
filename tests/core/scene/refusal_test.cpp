// SPDX-License-Identifier: Apache-2.0
// What a user reads when a native scene file is wrong: where, what, and what is accepted.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/core/scene/folder.h"

namespace tessera {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

struct Refused {
  std::string text, message;  // the beginning of the message
};

void PrintTo(const Refused& r, std::ostream* os) { *os << r.text; }

class RefusedScene : public testing::TestWithParam<Refused> {};

TEST_P(RefusedScene, SaysWhereAndWhatAndWhatIsAccepted) {
  const Folder folder;
  EXPECT_THAT(refusal(folder.write("s.json", GetParam().text)), StartsWith(GetParam().message));
}

INSTANTIATE_TEST_SUITE_P(
    Native, RefusedScene,
    testing::Values(
        Refused{"{\n\"name\": nope}", "s.json:2:10: syntax error"},
        Refused{"[]", "s.json:/: is an array; accepted: an object with the keys $schema, name, import"},
        Refused{R"({"sphere": []})",
                "s.json:/sphere: unknown key 'sphere'; did you mean 'spheres'?; accepted: "},
        Refused{R"({"spheres": [{"center": [0, 0, 0], "radios": 1}]})",
                "s.json:/spheres/0/radios: unknown key 'radios'; did you mean 'radius'?; accepted: center, "
                "radius, material"},
        Refused{R"({"spheres": [{"radius": 1}]})", "s.json:/spheres/0: the key 'center' is missing"},
        Refused{R"({"spheres": [{"center": [0, 0]}]})",
                "s.json:/spheres/0/center: has 2 elements; accepted: an array of 3, each a number from "
                "-1e+09 to 1e+09"},
        Refused{R"({"spheres": [{"center": [0, 0, "x"]}]})",
                "s.json:/spheres/0/center/2: is the string \"x\"; accepted: a number from -1e+09 to 1e+09"},
        Refused{R"({"spheres": [{"center": [0, 0, 0], "radius": 0}]})",
                "s.json:/spheres/0/radius: is 0; accepted: a number above 0, at most 1e+09"},
        Refused{R"({"spheres": [{"center": [0, 0, NaN]}]})", "s.json:1:"},
        Refused{R"({"spheres": [{"center": [0, 0, 1e999]}]})", "s.json:1:"},
        Refused{R"({"spheres": [{"center": [0, 0, 1e30]}]})",
                "s.json:/spheres/0/center/2: is 1e+30; accepted: "},
        Refused{R"({"spheres": [{"center": [0, 0, 0], "material": "glod"}], "materials": {"gold": {}}})",
                "s.json:/spheres/0/material: unknown material 'glod'; did you mean 'gold'?; accepted: gold"},
        Refused{R"({"materials": {"a/b": {"color": 1.5}}})",
                "s.json:/materials/a~1b/color: is 1.5; accepted: a number from 0 to 1, or an array of 3, "
                "each a number"},
        Refused{R"({"materials": {"a": {"type": "metallic"}}})",
                "s.json:/materials/a/type: unknown value 'metallic'; did you mean 'metal'?; accepted: "
                "diffuse, mirror"},
        Refused{R"({"materials": {"a": {"color_texture": "none.png"}}})",
                "s.json:/materials/a/color_texture: "},
        Refused{R"({"lights": [{"type": "sun"}]})",
                "s.json:/lights/0/type: unknown value 'sun'; accepted: point, spot, "
                "directional"},
        Refused{R"({"lights": [{"position": [0, 0, 0]}]})",
                "s.json:/lights/0: the key 'type' is missing; accepted: point"},
        Refused{R"({"lights": [{"type": "point", "position": [0, 0, 0], "direction": [0, 0, 1]}]})",
                "s.json:/lights/0/direction: unknown key 'direction'"},
        Refused{R"({"lights": [{"type": "directional", "direction": [0, 0, 0]}]})",
                "s.json:/lights/0/direction: has no length"},
        Refused{
            R"({"lights": [{"type": "spot", "position": [0, 0, 0], "direction": [0, 0, 1], "inner_angle": 50}]})",
            "s.json:/lights/0: inner_angle is larger than outer_angle"},
        Refused{R"({"camera": {}})", "s.json:/camera: 'look_at' or 'matrix' is missing"},
        Refused{R"({"camera": {"look_at": {"from": [0, 0, 0], "to": [0, 0, 0]}}})",
                "s.json:/camera/look_at: `from` and `to` are the same point"},
        Refused{R"({"camera": {"look_at": {"from": [0, 0, 0], "to": [0, 2, 0]}}})",
                "s.json:/camera/look_at: `up` points along the view"},
        Refused{
            R"({"camera": {"look_at": {"from": [0, 0, 0], "to": [0, 0, 1]}, "vertical_fov": 9, "horizontal_fov": 9}})",
            "s.json:/camera: 'vertical_fov' and 'horizontal_fov' cannot stand together; accepted: one of "
            "them"},
        Refused{R"({"camera": {"matrix": [0,0,0,0, 0,0,0,0, 0,0,0,0, 0,0,0,0]}})",
                "s.json: the camera '' looks nowhere"},
        Refused{R"({"import": [{"file": "none.gltf"}]})", "s.json:/import/0/file: "},
        Refused{R"({"import": [{"file": "model.blend"}]})",
                "s.json:/import/0/file: unknown kind of scene file '.blend'; accepted: .json, .gltf, .glb, "
                ".obj, .fbx, .ply"},
        Refused{R"({"environment": {"image": "none.hdr"}})", "s.json:/environment/image: "},
        Refused{R"({"meshes": {"m": {"positions": [[0, 0, 0]], "triangles": [[0, 0, 1]]}}})",
                "s.json:/meshes/m/triangles/0/2: there is no vertex 1; accepted: 0 to 0"},
        Refused{R"({"meshes": {"m": {"positions": [[0, 0, 0]], "triangles": [[0, 0, -1]]}}})",
                "s.json:/meshes/m/triangles/0/2: is -1; accepted: an integer from 0 to"},
        Refused{R"({"meshes": {"m": {"positions": [[0, 0, 0]], "triangles": [[0, 0, 0.5]]}}})",
                "s.json:/meshes/m/triangles/0/2: is 0.5; accepted: an integer"},
        Refused{R"({"meshes": {"m": {"positions": [[0, 0, 0]], "normals": []}}})",
                "s.json:/meshes/m/normals: has 0 elements; accepted: 1, one a vertex"},
        Refused{R"({"meshes": {"m": {"file": "a.obj", "positions": []}}})",
                "s.json:/meshes/m: 'file' and 'positions' cannot stand together"},
        Refused{R"({"instances": [{"mesh": "m"}]})", "s.json:/instances/0/mesh: unknown mesh 'm'"},
        Refused{R"({"name": 3})", "s.json:/name: is 3; accepted: a string"}));

TEST(RefusedFile, MissingOnesAreNamedWithThePlaceThatNamesThem) {
  const Folder folder;
  EXPECT_THAT(refusal(folder.path() / "none.json"), StartsWith("none.json: no such file"));
  EXPECT_THAT(refusal(folder.path() / "none.glb"), StartsWith("none.glb: no such file"));
  EXPECT_THAT(refusal(folder.path() / "none.obj"), StartsWith("none.obj: no such file"));
  EXPECT_THAT(refusal(folder.path() / "none.fbx"), StartsWith("none.fbx: no such file"));
  EXPECT_THAT(refusal(folder.path() / "none.blend"),
              AllOf(HasSubstr("'.blend'"), HasSubstr("accepted: .json, .gltf")));
  EXPECT_THAT(refusal(folder.write("s.json", R"({"import": [{"file": "none.gltf"}]})")),
              AllOf(StartsWith("s.json:/import/0/file: "), HasSubstr("none.gltf: no such file")));
}

TEST(RefusedCamera, OfAnUnknownNameIsAnsweredWithTheNearest) {
  Scene scene;
  for (const char* name : {"front", "side"}) scene.cameras.emplace_back().name = name;
  try {
    camera_index(scene, "frnt");
    FAIL();
  } catch (const InputError& e) {
    EXPECT_THAT(e.what(), HasSubstr("unknown camera 'frnt'; did you mean 'front'?; accepted: front, side"));
  }
}

}  // namespace
}  // namespace tessera
