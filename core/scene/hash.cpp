// SPDX-License-Identifier: Apache-2.0
// The content hash of a scene: SHA-256 (FIPS 180-4) over its fields in the order of scene.h, numbers as
// little-endian IEEE 754, every list preceded by its length. Names that no pixel depends on are left out.
#include <fmt/format.h>
#include <openssl/evp.h>

#include <bit>
#include <memory>
#include <span>
#include <stdexcept>

#include "core/scene/load.h"

namespace tessera {
namespace {

static_assert(std::endian::native == std::endian::little, "numbers are hashed as they lie in memory");
static_assert(sizeof(Vec3) == 12 && sizeof(Vec2) == 8 && sizeof(Color) == 12 && sizeof(Matrix) == 64);

class Hash {
 public:
  Hash() {
    if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1)
      throw std::runtime_error("SHA-256 is not available");
  }

  // Values without padding, as they lie in memory.
  template <class T>
  void add(std::span<const T> values) {
    add(static_cast<std::uint64_t>(values.size()));
    EVP_DigestUpdate(context_.get(), values.data(), values.size_bytes());
  }
  void add(const std::string& text) { add(std::span<const char>(text)); }
  void add(std::uint64_t v) { EVP_DigestUpdate(context_.get(), &v, sizeof v); }
  void add(int v) { add(static_cast<std::uint64_t>(static_cast<std::int64_t>(v))); }
  void add(float v) { EVP_DigestUpdate(context_.get(), &v, sizeof v); }
  void add(const Vec3& v) { EVP_DigestUpdate(context_.get(), &v, sizeof v); }
  void add(const Matrix& m) { EVP_DigestUpdate(context_.get(), &m, sizeof m); }

  void add(const Texture& t) { add_all(t.picture, static_cast<int>(t.wrap_u), static_cast<int>(t.wrap_v)); }
  void add(const Picture& p) {
    add_all(p.width, p.height, p.channels);
    add(std::span<const float>(p.pixels));
  }
  void add(const Material& m) {
    add_all(static_cast<int>(m.kind), m.base_color, m.base_color_texture, m.metallic, m.roughness,
            m.metallic_roughness_texture, m.normal_texture, m.normal_scale, m.emission, m.emission_texture,
            static_cast<int>(m.alpha), m.base_alpha, m.alpha_cutoff, m.ior, m.eta, m.k,
            static_cast<int>(m.double_sided));
  }
  void add(const Mesh& m) {
    add(std::span<const Vec3>(m.positions));
    add(std::span<const Vec3>(m.normals));
    add(std::span<const Vec2>(m.uvs));
    add(std::span<const std::array<std::uint32_t, 3>>(m.triangles));
    add(m.material);
  }
  void add(const Instance& i) { add_all(i.mesh, i.to_world); }
  void add(const Sphere& s) { add_all(s.center, s.radius, s.material); }
  void add(const PointLight& l) { add_all(l.position, l.intensity); }
  void add(const SpotLight& l) {
    add_all(l.position, l.direction, l.intensity, l.inner_angle, l.outer_angle);
  }
  void add(const DirectionalLight& l) { add_all(l.direction, l.irradiance, l.angular_diameter); }
  void add(const Environment& e) { add_all(e.radiance, e.picture, e.rotation); }
  void add(const Camera& c) {
    add_all(c.name, c.to_world, c.vertical_fov, c.horizontal_fov, c.lens_radius, c.focus_distance);
  }

  template <class T>
  void add_list(const std::vector<T>& list) {
    add(static_cast<std::uint64_t>(list.size()));
    for (const T& item : list) add(item);
  }

  std::string hex() {
    unsigned char digest[EVP_MAX_MD_SIZE];
    unsigned size = 0;
    EVP_DigestFinal_ex(context_.get(), digest, &size);
    return fmt::format("{:02x}", fmt::join(digest, digest + size, ""));
  }

 private:
  template <class... T>
  void add_all(const T&... values) {
    (add(values), ...);
  }

  std::unique_ptr<EVP_MD_CTX, decltype(&EVP_MD_CTX_free)> context_{EVP_MD_CTX_new(), EVP_MD_CTX_free};
};

}  // namespace

std::string content_hash(const Scene& scene) {
  Hash hash;
  hash.add_list(scene.pictures);
  hash.add_list(scene.materials);
  hash.add_list(scene.meshes);
  hash.add_list(scene.instances);
  hash.add_list(scene.spheres);
  hash.add_list(scene.points);
  hash.add_list(scene.spots);
  hash.add_list(scene.suns);
  hash.add(scene.environment);
  hash.add_list(scene.cameras);
  return hash.hex();
}

}  // namespace tessera
