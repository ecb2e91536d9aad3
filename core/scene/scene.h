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

// Pixels of a texture or environment, decoded. Row 0 is the top.
struct Picture {
  std::string name;                         // file or, for an embedded image, file#index: for messages
  int width = 0, height = 0, channels = 0;  // 1 to 4
  std::vector<float> pixels;                // interleaved, linear if decoded from sRGB
};

// How a material looks up a picture. uv (0, 0) is the top left corner, as in glTF.
struct Texture {
  enum class Wrap : std::uint8_t { repeat, mirror, clamp };
  int picture = -1;  // index into Scene::pictures; -1: none
  Wrap wrap_u = Wrap::repeat, wrap_v = Wrap::repeat;
  explicit operator bool() const { return picture >= 0; }
  bool operator==(const Texture&) const = default;
};

struct Material {
  enum class Kind : std::uint8_t {
    diffuse,             // Lambert, base_color
    mirror,              // perfect reflection, base_color is the reflectance
    glass,               // smooth dielectric: ior; base_color tints the transmission
    metal,               // GGX conductor: eta, k, roughness
    metallic_roughness,  // glTF 2.0 core material
  };
  enum class Alpha : std::uint8_t { opaque, mask };

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
  float ior = 1.5f;              // of glass, and of the dielectric part of metallic_roughness; 1..4
  Color eta{0.2f, 0.92f, 1.1f};  // metal: refractive index per channel (copper-like by default)
  Color k{3.9f, 2.45f, 2.14f};   // metal: extinction per channel
  bool double_sided = true;  // the back shades too, as in most renderers; glTF says otherwise per material
};

// Triangles, all of one material. Arrays are parallel to positions, or empty.
struct Mesh {
  std::string name;
  std::vector<Vec3> positions;
  std::vector<Vec3> normals;  // unit; empty: flat
  std::vector<Vec2> uvs;      // empty: no texture coordinates
  std::vector<std::array<std::uint32_t, 3>> triangles;
  int material = 0;
};

struct Instance {
  int mesh = 0;
  Matrix to_world;
};

struct Sphere {
  Vec3 center{0, 0, 0};
  float radius = 1.0f;
  int material = 0;
};

struct PointLight {
  Vec3 position{0, 0, 0};
  Color intensity{1, 1, 1};  // W/sr
};

struct SpotLight {
  Vec3 position{0, 0, 0};
  Vec3 direction{0, 0, -1};       // unit, the way the light travels
  Color intensity{1, 1, 1};       // W/sr on the axis
  float inner_angle = 0.0f;       // radians from the axis; full intensity within
  float outer_angle = 0.785398f;  // zero outside; between, the falloff of KHR_lights_punctual
};

// A sun. With a positive angular diameter it is a disc of constant radiance.
struct DirectionalLight {
  Vec3 direction{0, -1, 0};       // unit, the way the light travels
  Color irradiance{1, 1, 1};      // W/m^2 on a surface perpendicular to it
  float angular_diameter = 0.0f;  // radians, 0 to pi
};

struct Environment {
  Color radiance{0, 0, 0};  // constant radiance, or the factor of the picture
  int picture = -1;         // equirectangular; the centre of the picture is -Z turned by `rotation` about +Y
  float rotation = 0.0f;    // radians
};

// Thin lens. Looks down its local -Z, +Y up, as in glTF.
struct Camera {
  std::string name;
  Matrix to_world;
  float vertical_fov = 0.7f;    // radians; used if > 0
  float horizontal_fov = 0.0f;  // radians; used instead if > 0
  float lens_radius = 0.0f;     // metres; 0: pinhole
  float focus_distance = 1.0f;  // metres along the view axis
};

struct Scene {
  std::string name;
  std::vector<Picture> pictures;
  std::vector<Material> materials;
  std::vector<Mesh> meshes;
  std::vector<Instance> instances;
  std::vector<Sphere> spheres;
  std::vector<PointLight> points;
  std::vector<SpotLight> spots;
  std::vector<DirectionalLight> suns;
  Environment environment;
  std::vector<Camera> cameras;        // at least one after loading
  std::vector<std::string> warnings;  // what the importer did not understand
};

}  // namespace tessera
