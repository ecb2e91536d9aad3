// SPDX-License-Identifier: Apache-2.0
#include "core/scene/native/write.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>

#include "core/scene/json_text.h"
#include "core/scene/native/write_parts.h"

namespace tessera {
namespace {

bool is_there(const Environment& e) {
  return e.radiance != Color(0) || e.picture >= 0 || e.rotation != 0 || e.light != LightTraits{};
}

Json transform_json(const Matrix& m) {
  Members transform;
  transform.add("matrix", matrix(m));
  return transform.done();
}

// What stands at the beginning and the end of every scene that we write.
class Writer {
 public:
  Writer(const Scene& scene, const std::filesystem::path& folder)
      : scene_(scene), folder_(folder), names_(names_of(scene)) {}

  std::string whole() {
    add_head();
    add_cameras();
    add_lights();
    if (is_there(scene_.environment)) root_.add("environment", environment_json(scene_, folder_));
    if (scene_.background.kind != Background::Kind::environment)
      root_.add("background", background_json(scene_.background));
    add_materials();
    add_by_name("objects", names_.objects,
                [&](std::size_t i) { return object_json(scene_, scene_.objects[i], names_.objects[i]); });
    add_meshes();
    add_shapes();
    add_variants();
    return json_text(root_.done());
  }

  std::string importing(const std::filesystem::path& file) {
    root_.add("name", text(scene_.name));
    Members import;
    import.add("file", text(relative_to(folder_, file)));
    root_.add("import", {Json::Array{import.done()}});
    if (scene_.cameras.size() == 1 && scene_.cameras[0].name.empty() && scene_.cameras[0].track < 0) {
      root_.list.back().second.value = Json::Array{without_cameras(file)};
      root_.add("camera", camera_json(scene_, scene_.cameras[0]));
    }
    if (is_there(scene_.environment) && scene_.environment.picture < 0)
      root_.add("environment", environment_json(scene_, folder_));
    add_materials_to_edit();
    return json_text(root_.done());
  }

 private:
  Json without_cameras(const std::filesystem::path& file) const {
    Members import;
    import.add("file", text(relative_to(folder_, file)));
    import.add("cameras", {false});
    return import.done();
  }

  void add_head() {
    root_.add("name", text(scene_.name));
    if (scene_.frames_per_second != Scene{}.frames_per_second)
      root_.add("frames_per_second", number(scene_.frames_per_second));
    Json::Array groups;
    for (const std::string& group : scene_.light_groups) groups.push_back(text(group));
    if (!groups.empty()) root_.add("light_groups", {std::move(groups)});
  }

  template <class Item>
  void add_list(std::string key, std::size_t count, const Item& item) {
    Json::Array list;
    for (std::size_t i = 0; i < count; ++i) list.push_back(item(i));
    if (!list.empty()) root_.add(std::move(key), {std::move(list)});
  }

  template <class Item>
  void add_by_name(std::string key, const std::vector<std::string>& names, const Item& item) {
    Members members;
    for (std::size_t i = 0; i < names.size(); ++i) members.add(names[i], item(i));
    if (!members.list.empty()) root_.add(std::move(key), members.done());
  }

  void add_cameras() {
    if (scene_.cameras.empty()) return;
    root_.add("camera", camera_json(scene_, scene_.cameras[0]));
    add_list("cameras", scene_.cameras.size() - 1,
             [&](std::size_t i) { return camera_json(scene_, scene_.cameras[i + 1]); });
  }

  void add_lights() {
    Json::Array lights;
    for (const PointLight& l : scene_.points) lights.push_back(point_light_json(scene_, l));
    for (const SpotLight& l : scene_.spots) lights.push_back(spot_json(scene_, l));
    for (const DirectionalLight& l : scene_.suns) lights.push_back(sun_json(scene_, l));
    if (!lights.empty()) root_.add("lights", {std::move(lights)});
  }

  void add_materials() {
    add_by_name("materials", names_.materials, [&](std::size_t i) {
      return material_json(scene_, names_, scene_.materials[i], folder_, true);
    });
  }

  // A material that shares its name with none and is no mix, which names others.
  void add_materials_to_edit() {
    std::map<std::string, int> uses;
    for (const Material& m : scene_.materials) ++uses[m.name];
    Members members;
    for (const Material& m : scene_.materials)
      if (!m.name.empty() && uses[m.name] == 1 && m.kind != Material::Kind::mix)
        members.add(m.name, material_json(scene_, names_, m, folder_, false));
    if (!members.list.empty()) root_.add("materials", members.done());
  }

  void add_meshes() {
    std::vector<bool> placed(scene_.meshes.size());
    for (const Instance& i : scene_.instances) placed[static_cast<std::size_t>(i.mesh)] = true;
    add_by_name("meshes", names_.meshes,
                [&](std::size_t i) { return mesh_json(names_, scene_.meshes[i], placed[i]); });
    add_list("instances", scene_.instances.size(), [&](std::size_t i) {
      const Instance& instance = scene_.instances[i];
      Members members;
      members.add("mesh", text(names_.meshes[static_cast<std::size_t>(instance.mesh)]));
      if (instance.to_world != Matrix()) members.add("transform", transform_json(instance.to_world));
      if (instance.object >= 0)
        members.add("object", text(names_.objects[static_cast<std::size_t>(instance.object)]));
      return members.done();
    });
  }

  template <class Shape>
  Json finished(Members&& members, const Shape& shape) {
    members.add("material", text(names_.materials[static_cast<std::size_t>(shape.material)]));
    if (shape.object >= 0)
      members.add("object", text(names_.objects[static_cast<std::size_t>(shape.object)]));
    return members.done();
  }

  void add_shapes() {
    add_list("spheres", scene_.spheres.size(), [&](std::size_t i) {
      const Sphere& s = scene_.spheres[i];
      Members members;
      members.add("center", point(s.center));
      members.add("radius", number(s.radius));
      return finished(std::move(members), s);
    });
    add_list("quads", scene_.quads.size(), [&](std::size_t i) {
      const Quad& q = scene_.quads[i];
      Members members;
      members.add("corner", point(q.corner));
      members.add("edge_u", point(q.edge_u));
      members.add("edge_v", point(q.edge_v));
      return finished(std::move(members), q);
    });
    add_list("disks", scene_.disks.size(), [&](std::size_t i) {
      const Disk& d = scene_.disks[i];
      Members members;
      members.add("center", point(d.center));
      members.add("normal", point(d.normal));
      members.add("radius", number(d.radius));
      return finished(std::move(members), d);
    });
  }

  void add_variants() {
    add_list("variants", scene_.variants.size(), [&](std::size_t i) {
      Json::Array choices;
      for (const Variant::Choice& c : scene_.variants[i].choices) {
        Members choice;
        choice.add("mesh", text(names_.meshes[static_cast<std::size_t>(c.mesh)]));
        choice.add("material", text(names_.materials[static_cast<std::size_t>(c.material)]));
        choices.push_back(choice.done());
      }
      Members variant;
      variant.add("name", text(scene_.variants[i].name));
      variant.add("choices", {std::move(choices)});
      return variant.done();
    });
  }

  const Scene& scene_;
  const std::filesystem::path& folder_;
  const Names names_;
  Members root_;
};

}  // namespace

std::optional<std::string> obstacle_to_inline(const Scene& scene) {
  std::size_t vertices = 0, triangles = 0;
  for (const Mesh& m : scene.meshes) vertices += m.positions.size(), triangles += m.triangles.size();
  if (vertices > kMaxInlineVertices || triangles > kMaxInlineTriangles)
    return fmt::format("it has {} vertices and {} triangles, more than {} and {}", vertices, triangles,
                       kMaxInlineVertices, kMaxInlineTriangles);
  std::error_code none;
  for (const Picture& p : scene.pictures)
    if (!std::filesystem::is_regular_file(p.name, none))
      return fmt::format("the picture '{}' is no file of its own", p.name);
  return std::nullopt;
}

std::string whole_scene_text(const Scene& scene, const std::filesystem::path& folder) {
  return Writer(scene, folder).whole();
}

std::string importing_text(const Scene& scene, const std::filesystem::path& file,
                           const std::filesystem::path& folder) {
  return Writer(scene, folder).importing(file);
}

}  // namespace tessera
