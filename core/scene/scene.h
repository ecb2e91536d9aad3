// SPDX-License-Identifier: Apache-2.0
// A scene as data: what every importer produces and the renderer reads. World space is right-handed, in
// metres, +Y up (importers convert). Colours are linear, Rec. 709 primaries. No rendering, no files being
// open.
#pragma once

#include <Imath/ImathColor.h>
#include <Imath/ImathMatrix.h>
#include <Imath/ImathVec.h>

#include <array>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace tessera {

using Vec2 = Imath::V2f;
using Vec3 = Imath::V3f;
using Color = Imath::C3f;
using Matrix = Imath::M44f;  // row vectors: p' = p * M, as in Imath and OpenEXR

// What the numbers of an integer file mean. Files of floats are linear whatever is asked for.
enum class Encoding : std::uint8_t { srgb, linear };

// A texture or environment: its pixels or, where they are not all needed at once, the image that has them.
// Row 0 is the top. A set of UDIM tiles is one picture.
struct Picture {
  std::string name;                         // file or, for an embedded image, file#index
  int width = 0, height = 0, channels = 0;  // 1 to 4; of the first tile
  std::vector<float> pixels;  // interleaved, linear; empty: with_pixels() reads them (pictures.h)
  Encoding encoding = Encoding::srgb;
  std::string digest;  // hex SHA-256 of the encoded image when the scene was loaded; empty: there is none
  std::shared_ptr<const std::string> bytes;  // the encoded image if it was embedded; shared by copies
  std::vector<Picture> tiles;                // by rising udim; a picture with tiles is nothing but them
  int udim = 0;  // of a tile: 1001 + column + 10 row, rows counted from the bottom
};

// How a material looks up a picture. uv (0, 0) is the top left corner, as in glTF.
struct Texture {
  enum class Wrap : std::uint8_t { repeat, mirror, clamp };
  int picture = -1;  // index into Scene::pictures; -1: none
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  std::uint8_t uv_set = 0;  // 0: Mesh::uvs, 1: Mesh::uvs2
  // Of the mesh's (u, v): u' = t[0] u + t[1] v + t[2], v' = t[3] u + t[4] v + t[5] (KHR_texture_transform).
  std::array<float, 6> transform{1, 0, 0, 0, 1, 0};
  explicit operator bool() const { return picture >= 0; }
  bool operator==(const Texture&) const = default;
};

struct Material {
  enum class Kind : std::uint8_t {
    diffuse,             // Lambert, base_color
    mirror,              // perfect reflection, base_color is the reflectance
    glass,               // dielectric: ior, roughness, thin; base_color tints the transmission
    metal,               // conductor: eta, k; GGX of `roughness`, or the cosine lobe of `exponent`
    metallic_roughness,  // glTF 2.0 core material and the KHR_materials_ extensions below
    translucent,  // thin sheet that scatters base_color back and transmission_color through, both Lambert
    plastic,      // Lambert base_color under a dielectric boundary: ior, roughness
    mix,          // of the materials `first` and `second`
    unlit,        // shows base_color whatever the light; scatters nothing, lights nothing
  };
  enum class Alpha : std::uint8_t {
    opaque,
    mask,   // there where alpha >= alpha_cutoff
    blend,  // there with probability alpha
  };

  std::string name;
  Kind kind = Kind::diffuse;
  Color base_color{0.8f, 0.8f, 0.8f};  // 0..1
  Texture base_color_texture;  // multiplies base_color; its alpha is for Alpha::mask. Decoded from sRGB
  float metallic = 0.0f;       // 0..1
  float roughness = 1.0f;      // 0..1; GGX alpha = roughness^2
  Texture metallic_roughness_texture;  // glTF: G roughness, B metallic; multiply. Linear
  Texture normal_texture;              // tangent space, +Y up. Linear
  float normal_scale = 1.0f;
  Color emission{0, 0, 0};   // radiance, W/(sr m^2), >= 0; both sides if double_sided, else the front
  Texture emission_texture;  // multiplies emission. Decoded from sRGB
  Alpha alpha = Alpha::opaque;
  float base_alpha = 1.0f;  // 0..1, multiplies the texture's alpha
  float alpha_cutoff = 0.5f;
  float ior = 1.5f;              // of glass, plastic, and the dielectric part of metallic_roughness; 1..4
  Color eta{0.2f, 0.92f, 1.1f};  // metal: refractive index per channel (copper-like by default)
  Color k{3.9f, 2.45f, 2.14f};   // metal: extinction per channel
  // metal: if > 0, light spreads about the mirror direction as its cosine to this power, in place of GGX (the
  // glossy material of van de Vlasakker 2013, section 3.2); 0..1e6
  float exponent = 0.0f;
  bool double_sided = true;  // the back shades too, as in most renderers; glTF says otherwise per material

  Color transmission_color{0.0f, 0.0f, 0.0f};  // translucent; 0..1, base_color + transmission_color <= 1
  float transmission = 0.0f;  // KHR_materials_transmission: share of the diffuse part that goes through; 0..1
  Texture transmission_texture;  // R; multiplies. Linear
  // glass, metallic_roughness: a sheet without inside, light goes through unbent; else a boundary of a solid.
  bool thin = false;
  // Inside of a solid: white light is attenuation_color after attenuation_distance metres; 0: clear.
  Color attenuation_color{1, 1, 1};  // 0..1
  float attenuation_distance = 0.0f;

  float clearcoat = 0.0f;     // KHR_materials_clearcoat; 0..1
  Texture clearcoat_texture;  // R; multiplies. Linear
  float clearcoat_roughness = 0.0f;
  Texture clearcoat_roughness_texture;  // G; multiplies. Linear
  Texture clearcoat_normal_texture;     // Linear
  float clearcoat_normal_scale = 1.0f;

  Color sheen_color{0, 0, 0};   // KHR_materials_sheen; 0..1
  Texture sheen_color_texture;  // multiplies. Decoded from sRGB
  float sheen_roughness = 0.0f;
  Texture sheen_roughness_texture;  // A; multiplies. Linear

  int first = -1,
      second = -1;      // mix: indices into Scene::materials; never a cycle, at most kMaxMixDepth deep
  float mix = 0.5f;     // share of `second`; 0..1
  Texture mix_texture;  // R; multiplies. Linear
};
inline constexpr int kMaxMixDepth = 3;  // levels of mix above a material that is none

// Triangles, all of one material. Arrays are parallel to positions, or empty.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // unit; empty: flat
  std::vector<Vec2> uvs;      // empty: no texture coordinates
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int material = 0;
  std::vector<Vec2> uvs2;                    // the second set; empty: none
  std::vector<std::array<float, 4>> colors;  // multiply base_color and base_alpha, linear; empty: white
};

// How the light of a light or of an emitting object counts.
struct LightTraits {
  int group = -1;                         // index into Scene::light_groups; -1: none
  float diffuse = 1.0f, specular = 1.0f;  // factors of what diffuse and specular scattering makes of it; >= 0
  bool operator==(const LightTraits&) const = default;
};

// A rigid movement: poses at rising times (seconds), parallel lists, at least one; constant before the first
// and after the last. Between two, interpolated as scale, rotation (shortest way) and translation.
struct Track {
  std::vector<float> times;
  std::vector<Matrix> poses;
};

// What several instances or shapes have in common: one thing to the user.
struct Object {
  std::string name;
  bool camera = true, scattered = true,
       shadow = true;    // which rays see it: from the camera, bounced, to lights
  bool catcher = false;  // shadow catcher: the camera sees only the shadow on it, other rays what it is
  LightTraits light;     // if its material emits
  int track = -1;        // index into Scene::tracks: an instance stands at to_world * pose; -1: it rests
};

struct Instance {
  int mesh = 0;
  Matrix to_world;
  int object = -1;  // index into Scene::objects; -1: Object{}
};

struct Sphere {
  Vec3 center{0, 0, 0};
  float radius = 1.0f;
  int material = 0;
  int object = -1;
};

// A parallelogram corner, corner + edge_u, corner + edge_u + edge_v, corner + edge_v; its front is on the
// side of edge_u x edge_v; texture coordinates grow along the edges.
struct Quad {
  Vec3 corner{0, 0, 0}, edge_u{1, 0, 0}, edge_v{0, 1, 0};
  int material = 0;
  int object = -1;
};

struct Disk {
  Vec3 center{0, 0, 0};
  Vec3 normal{0, 1, 0};  // unit, on the front
  float radius = 1.0f;
  int material = 0;
  int object = -1;
};

struct PointLight {
  Vec3 position{0, 0, 0};
  Color intensity{1, 1, 1};  // W/sr
  LightTraits light;
};

struct SpotLight {
  Vec3 position{0, 0, 0};
  Vec3 direction{0, 0, -1};       // unit, the way the light travels
  Color intensity{1, 1, 1};       // W/sr on the axis
  float inner_angle = 0.0f;       // radians from the axis; full intensity within
  float outer_angle = 0.785398f;  // zero outside; between, the falloff of KHR_lights_punctual
  LightTraits light;
};

// A sun. With a positive angular diameter it is a disc of constant radiance.
struct DirectionalLight {
  Vec3 direction{0, -1, 0};       // unit, the way the light travels
  Color irradiance{1, 1, 1};      // W/m^2 on a surface perpendicular to it
  float angular_diameter = 0.0f;  // radians, 0 to pi
  bool camera = true;             // the camera sees its disc
  LightTraits light;
};

struct Environment {
  Color radiance{0, 0, 0};  // constant radiance, or the factor of the picture
  int picture = -1;         // equirectangular; the centre of the picture is -Z turned by `rotation` about +Y
  float rotation = 0.0f;    // radians
  LightTraits light;
};

// What the camera sees where there is nothing. Light comes from the environment all the same.
struct Background {
  enum class Kind : std::uint8_t { environment, color, transparent };
  Kind kind = Kind::environment;
  Color color{0, 0, 0};  // of Kind::color
};

// Looks down its local -Z, +Y up, as in glTF.
struct Camera {
  enum class Projection : std::uint8_t {
    perspective,   // thin lens
    orthographic,  // `height` world units high, or `width` wide
    panorama,  // equirectangular: the frame is 360 x 180 degrees, its centre is -Z, its right half towards +X
  };
  std::string name;
  Projection projection = Projection::perspective;
  Matrix to_world;
  float vertical_fov = 0.7f;    // radians; used if > 0
  float horizontal_fov = 0.0f;  // radians; used instead if > 0
  float height = 1.0f;          // orthographic: world units; used unless width > 0
  float width = 0.0f;
  float lens_radius = 0.0f;     // metres; 0: pinhole; not of a panorama
  int blades = 0;               // of the aperture; below 3: round
  float blade_rotation = 0.0f;  // radians, counter-clockwise as the camera sees
  float focus_distance = 1.0f;  // metres along the view axis
  bool autofocus = false;       // focus instead on what lies in the middle of the frame
  // The shutter is open from `frame + shutter_open` to `frame + shutter_close`, in frames; equal: no motion
  // blur.
  float shutter_open = 0.0f, shutter_close = 0.0f;  // -1..1
  int track = -1;  // index into Scene::tracks: the camera stands at to_world * pose
};

// Another choice of materials for some meshes (KHR_materials_variants).
struct Variant {
  struct Choice {
    int mesh = 0, material = 0;
  };
  std::string name;
  std::vector<Choice> choices;
};

inline constexpr int kMaxLightGroups = 8;

struct Scene {
  std::string name;
  std::vector<Picture> pictures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Object> objects;
  std::vector<Instance> instances;
  std::vector<Sphere> spheres;
  std::vector<Quad> quads;
  std::vector<Disk> disks;
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<DirectionalLight> suns;
  Environment environment;
  Background background;
  std::vector<std::string> light_groups;  // at most kMaxLightGroups names
  std::vector<Track> tracks;
  float frames_per_second = 24.0f;  // frame f is at f / frames_per_second seconds
  std::vector<Variant> variants;
  std::vector<Camera> cameras;        // at least one after loading
  std::vector<std::string> warnings;  // what the importer did not understand
  std::vector<std::string> files;     // that were read for it, each once; the first is the scene file
};

}  // namespace tessera
