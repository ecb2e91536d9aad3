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
        Refused{"[]",
                "s.json:/: is an array; accepted: an object with the keys $schema, name, frames_per_second"},
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
        Refused{R"({"camera": {}})", "s.json:/camera: 'look_at' or 'matrix' or 'keys' is missing"},
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

// A camera, then more keys of it.
Refused camera(const std::string& keys, const std::string& message) {
  return {R"({"camera": {"look_at": {"from": [0, 0, 1], "to": [0, 0, 0]}, )" + keys + "}}",
          "s.json:/camera" + message};
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, RefusedScene,
    testing::Values(
        camera(R"("projection": "fisheye")",
               "/projection: unknown value 'fisheye'; accepted: perspective, orthographic, panorama"),
        camera(R"("projection": "panorama", "lens_radius": 1)",
               "/lens_radius: 'lens_radius' means nothing to the projection panorama"),
        camera(R"("projection": "orthographic", "vertical_fov": 40)",
               "/vertical_fov: 'vertical_fov' means nothing to the projection orthographic"),
        camera(R"("height": 4)", "/height: 'height' means nothing to the projection perspective"),
        camera(R"("projection": "orthographic", "height": 4, "width": 4)",
               ": 'height' and 'width' cannot stand together"),
        camera(R"("lens_radius": 1, "f_stop": 2)", ": 'lens_radius' and 'f_stop' cannot stand together"),
        camera(R"("focus_distance": "far")", "/focus_distance: unknown value 'far'; accepted: auto"),
        camera(R"("focus_distance": true)",
               "/focus_distance: is true; accepted: a number above 0, at most 1e+09, or \"auto\""),
        camera(R"("shutter": {"open": 0.5, "close": 0})", "/shutter: the shutter closes before it opens"),
        camera(R"("keys": [{"time": 1}, {"time": 1}])",
               "/keys/1/time: is not after the time of the key before; accepted: rising times"),
        camera(R"("keys": [])", "/keys: has 0 elements"),
        camera(R"("keys": [{"time": 0, "matrix": [0,0,0,0, 0,1,0,0, 0,0,1,0, 0,0,0,1]}])",
               "/keys/0: shrinks to nothing")));

INSTANTIATE_TEST_SUITE_P(
    Parts, RefusedScene,
    testing::Values(
        Refused{R"({"background": "blue"})",
                "s.json:/background: unknown value 'blue'; accepted: environment, transparent"},
        Refused{R"({"background": 3})",
                "s.json:/background: is 3; accepted: \"environment\", \"transparent\", or an "},
        Refused{R"({"frames_per_second": 0})", "s.json:/frames_per_second: is 0; accepted: a number above 0"},
        Refused{R"({"light_groups": ["key", "key"]})", "s.json:/light_groups/1: is empty, or there twice"},
        Refused{R"({"light_groups": ["key"], "environment": {"group": "kye"}})",
                "s.json:/environment/group: unknown light group 'kye'; did you mean 'key'?; accepted: key"},
        Refused{R"({"light_groups": ["1","2","3","4","5","6","7","8","9"]})",
                "s.json:/light_groups: has 9 elements"},
        Refused{R"({"materials": {"a": {"metal": "mithril"}}})",
                "s.json:/materials/a/metal: unknown value 'mithril'"},
        Refused{R"({"materials": {"a": {"metal": "gold", "eta": 1}}})",
                "s.json:/materials/a: 'metal' and 'eta' cannot stand together"},
        Refused{R"({"materials": {"a": {"type": "glass", "metal": "gold"}}})",
                "s.json:/materials/a/metal: 'metal' means nothing to glass"},
        Refused{
            R"({"materials": {"a": {"type": "translucent", "color": 0.5, "transmission_color": [0, 0.75, 0]}}})",
            "s.json:/materials/a: color and transmission_color add up to 1.25; accepted: at most 1"},
        Refused{R"({"materials": {"a": {"type": "mix", "first": "a"}}})",
                "s.json:/materials/a: the key 'second' is missing"},
        Refused{R"({"materials": {"a": {"type": "mix", "first": "b", "second": "c"}, "b": {}}})",
                "s.json:/materials/a/second: unknown material 'c'"},
        Refused{R"({"materials": {"a": {"type": "mix", "first": "a", "second": "b"}, "b": {}}})",
                "s.json:/materials: the mix 'a' has no end, or too many levels; accepted: 3 levels"},
        Refused{R"({"materials": {"a": {"color_texture": {"file": "x.png", "uv_set": 2}}}})",
                "s.json:/materials/a/color_texture/uv_set: is 2; accepted: an integer from 0 to 1"},
        Refused{
            R"({"materials": {"a": {"color_texture": {"file": "x.png", "transform": {"matrix": [1, 0, 0, 0, 1, 0], "scale": [1, 1]}}}}})",
            "s.json:/materials/a/color_texture/transform: 'matrix' and 'scale' cannot stand together"},
        Refused{R"({"objects": {"a": {"visibilty": true}}})",
                "s.json:/objects/a/visibilty: unknown key 'visibilty'; did you mean 'visibility'?"},
        Refused{R"({"objects": {"a": {"material": "none"}}})",
                "s.json:/objects/a/material: unknown material 'none'"},
        Refused{R"({"spheres": [{"center": [0, 0, 0], "object": "bal"}], "objects": {"ball": {}}})",
                "s.json:/spheres/0/object: unknown object 'bal'; did you mean 'ball'?; accepted: ball"},
        Refused{
            R"({"disks": [{"center": [0, 0, 0], "normal": [0, 1, 0], "object": "a"}], "objects": {"a": {"keys": [{"time": 0}]}}})",
            "s.json:/disks/0/object: 'a' moves, which spheres, quads and disks cannot; accepted: an object "},
        Refused{R"({"quads": [{"corner": [0, 0, 0], "edge_u": [1, 0, 0], "edge_v": [2, 0, 0]}]})",
                "s.json:/quads/0: has no area; accepted: edges that are not parallel"},
        Refused{R"({"disks": [{"center": [0, 0, 0], "normal": [0, 0, 0]}]})",
                "s.json:/disks/0/normal: has no length"},
        Refused{R"({"meshes": {"m": {"positions": [[0, 0, 0]], "colors": []}}})",
                "s.json:/meshes/m/colors: has 0 elements; accepted: 1, one a vertex"},
        Refused{R"({"variants": [{"name": "v", "choices": [{"mesh": "m", "material": "a"}]}]})",
                "s.json:/variants/0/choices/0/mesh: unknown mesh 'm'"}));

TEST(RefusedImport, OfAFileThatMovesAsOneObject) {
  const Folder folder;
  folder.write("part.json", R"({"objects": {"o": {"keys": [{"time": 0}]}}})");
  EXPECT_THAT(refusal(folder.write(
                  "s.json", R"({"import": [{"file": "part.json", "object": "a"}], "objects": {"a": {}}})")),
              StartsWith("s.json:/import/0/object: what is in the file moves, and cannot become one object"));
}

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
