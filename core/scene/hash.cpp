// SPDX-License-Identifier: Apache-2.0
// The content hash of a scene: SHA-256 (FIPS 180-4) over its fields in the order of scene.h, numbers as
// little-endian IEEE 754, every list preceded by its length. Names that no pixel depends on are left out.
#include <bit>
#include <span>

#include "core/scene/load.h"
#include "core/sha256.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as they lie in memory");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8 && sizeof(Color) == 12 && sizeof(Matrix) == 64);

class Hash {
 public:
  // Values without padding, as they lie in memory.
  template <class T>
  void add(std::span<const T> values) {
    add(static_cast<std::uint64_t>(values.size()));
    hash_.add(values.data(), values.size_bytes());
  }
  void add(const std::string& text) { add(std::span<const char>(text)); }
  void add(std::uint64_t v) { hash_.add(&v, sizeof v); }
  void add(int v) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(v))); }
  void add(float v) { hash_.add(&v, sizeof v); }
  void add(const Vec3& v) { hash_.add(&v, sizeof v); }
  void add(const Matrix& m) { hash_.add(&m, sizeof m); }

  void add(bool v) { add(static_cast<int>(v)); }
  template <class E>
  requires std::is_enum_v<E>
  void add(E v) { add(static_cast<int>(v)); }

  void add(const Texture& t) {
    add_all(t.picture, t.wrap_u, t.wrap_v, static_cast<int>(t.uv_set));
    add(std::span<const float>(t.transform));
  }
  void add(const Picture& p) {
    add_all(p.width, p.height, p.channels, p.encoding, p.digest, p.udim);
    add(std::span<const float>(p.pixels));
    add_list(p.tiles);
  }
  void add(const Material& m) {
    add_all(m.kind, m.base_color, m.base_color_texture, m.metallic, m.roughness, m.metallic_roughness_texture,
            m.normal_texture, m.normal_scale, m.emission, m.emission_texture, m.alpha, m.base_alpha,
            m.alpha_cutoff, m.ior, m.eta, m.k, m.exponent, m.double_sided);
    add_all(m.transmission_color, m.transmission, m.transmission_texture, m.thin, m.attenuation_color,
            m.attenuation_distance);
    add_all(m.clearcoat, m.clearcoat_texture, m.clearcoat_roughness, m.clearcoat_roughness_texture,
            m.clearcoat_normal_texture, m.clearcoat_normal_scale);
    add_all(m.sheen_color, m.sheen_color_texture, m.sheen_roughness, m.sheen_roughness_texture, m.first,
            m.second, m.mix, m.mix_texture);
  }
  void add(const Mesh& m) {
    add(std::span<const Vec3>(m.positions));
    add(std::span<const Vec3>(m.normals));
    add(std::span<const Vec2>(m.uvs));
    add(std::span<const Vec2>(m.uvs2));
    add(std::span<const std::array<float, 4>>(m.colors));
    add(std::span<const std::array<std::uint32_t, 3>>(m.triangles));
    add(m.material);
  }
  void add(const LightTraits& t) { add_all(t.group, t.diffuse, t.specular); }
  // Its name is in the manifest of a Cryptomatte.
  void add(const Object& o) { add_all(o.name, o.camera, o.scattered, o.shadow, o.catcher, o.light, o.track); }
  void add(const Track& t) {
    add(std::span<const float>(t.times));
    add(std::span<const Matrix>(t.poses));
  }
  void add(const Instance& i) { add_all(i.mesh, i.to_world, i.object); }
  void add(const Sphere& s) { add_all(s.center, s.radius, s.material, s.object); }
  void add(const Quad& q) { add_all(q.corner, q.edge_u, q.edge_v, q.material, q.object); }
  void add(const Disk& d) { add_all(d.center, d.normal, d.radius, d.material, d.object); }
  void add(const PointLight& l) { add_all(l.position, l.intensity, l.light); }
  void add(const SpotLight& l) {
    add_all(l.position, l.direction, l.intensity, l.inner_angle, l.outer_angle, l.light);
  }
  void add(const DirectionalLight& l) {
    add_all(l.direction, l.irradiance, l.angular_diameter, l.camera, l.light);
  }
  void add(const Environment& e) { add_all(e.radiance, e.picture, e.rotation, e.light); }
  void add(const Background& b) { add_all(b.kind, b.color); }
  void add(const Variant::Choice& c) { add_all(c.mesh, c.material); }
  void add(const Variant& v) {
    add(v.name);
    add_list(v.choices);
  }
  void add(const Camera& c) {
    add_all(c.name, c.projection, c.to_world, c.vertical_fov, c.horizontal_fov, c.height, c.width,
            c.lens_radius, c.blades, c.blade_rotation, c.focus_distance, c.autofocus, c.shutter_open,
            c.shutter_close, c.track);
  }

  template <class T>
  void add_list(const std::vector<T>& list) {
    add(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) add(item);
  }

  std::string hex() { return hash_.hex(); }

 private:
  template <class... T>
  void add_all(const T&... values) {
    (add(values), ...);
  }

  Sha256 hash_;
};

}  // namespace

std::string content_hash(const Scene& scene) {
  Hash hash;
  hash.add_list(scene.pictures);
  hash.add_list(scene.materials);
  hash.add_list(scene.meshes);
  hash.add_list(scene.objects);
  hash.add_list(scene.instances);
  hash.add_list(scene.spheres);
  hash.add_list(scene.quads);
  hash.add_list(scene.disks);
  hash.add_list(scene.points);
  hash.add_list(scene.spots);
  hash.add_list(scene.suns);
  hash.add(scene.environment);
  hash.add(scene.background);
  hash.add_list(scene.light_groups);
  hash.add_list(scene.tracks);
  hash.add(scene.frames_per_second);
  hash.add_list(scene.variants);
  hash.add_list(scene.cameras);
  return hash.hex();
}

}  // namespace tessera
