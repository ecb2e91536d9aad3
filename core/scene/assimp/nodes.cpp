// SPDX-License-Identifier: Apache-2.0
#include "core/scene/assimp/nodes.h"

#include <assimp/camera.h>
#include <assimp/light.h>
#include <assimp/scene.h>
#include <fmt/format.h>

#include <map>

#include "core/scene/import.h"

namespace tessera::assimp {
namespace {

// assimp's matrices are for column vectors.
Matrix as_matrix(const aiMatrix4x4& m) {
  return {m.a1, m.b1, m.c1, m.d1, m.a2, m.b2, m.c2, m.d2, m.a3, m.b3, m.c3, m.d3, m.a4, m.b4, m.c4, m.d4};
}

Vec3 as_vec3(const aiVector3D& v) { return {v.x, v.y, v.z}; }

Vec3 turned(const Vec3& direction, const Matrix& m) {
  Vec3 result;
  m.multDirMatrix(direction, result);
  return result.normalized();
}

class Nodes {
 public:
  Nodes(Scene& scene, const aiScene& from, const std::vector<int>& meshes, const ImportLimits& limits,
        const std::string& file)
      : scene_(scene), from_(from), meshes_(meshes), limits_(limits), file_(file) {
    for (unsigned c = 0; c < from.mNumCameras; ++c) cameras_.emplace(from.mCameras[c]->mName.C_Str(), c);
    for (unsigned l = 0; l < from.mNumLights; ++l) lights_.emplace(from.mLights[l]->mName.C_Str(), l);
  }

  void visit(const aiNode& node, const Matrix& parent, std::uint64_t depth) {
    require_at_most(limits_.node_depth, depth, "parents above a node", file_);
    const Matrix world = as_matrix(node.mTransformation) * parent;
    const std::string name = node.mName.C_Str();
    add_instances(node, name, world);
    for (auto [c, end] = cameras_.equal_range(name); c != end; ++c)
      add_camera(*from_.mCameras[c->second], world);
    for (auto [l, end] = lights_.equal_range(name); l != end; ++l)
      add_light(*from_.mLights[l->second], world);
    for (unsigned c = 0; c < node.mNumChildren; ++c) visit(*node.mChildren[c], world, depth + 1);
  }

 private:
  void warn_here(std::string_view what) { warn(scene_, fmt::format("{}: {}", file_, what)); }

  void add_instances(const aiNode& node, const std::string& name, const Matrix& world) {
    int object = -1;
    for (unsigned m = 0; m < node.mNumMeshes; ++m) {
      const int mesh = node.mMeshes[m] < meshes_.size() ? meshes_[node.mMeshes[m]] : -1;
      if (mesh < 0) continue;
      if (object < 0) {
        object = static_cast<int>(scene_.objects.size());
        scene_.objects.emplace_back().name = name;
      }
      require_at_most(limits_.instances, scene_.instances.size() + 1, "instances", file_);
      scene_.instances.push_back({mesh, world, object});
    }
  }

  void add_camera(const aiCamera& from, const Matrix& node) {
    Camera camera;
    camera.name = from.mName.C_Str();
    const Vec3 back = -as_vec3(from.mLookAt).normalized();
    const Vec3 x = as_vec3(from.mUp).cross(back).normalized(), y = back.cross(x),
               at = as_vec3(from.mPosition);
    camera.to_world =
        Matrix(x.x, x.y, x.z, 0, y.x, y.y, y.z, 0, back.x, back.y, back.z, 0, at.x, at.y, at.z, 1) * node;
    if (from.mOrthographicWidth > 0) {
      camera.projection = Camera::Projection::orthographic;
      camera.width = 2 * from.mOrthographicWidth;  // of assimp: half of what is seen
    } else if (from.mHorizontalFOV > 0 && from.mHorizontalFOV < 3.1f) {
      camera.horizontal_fov = from.mHorizontalFOV;
    } else {
      warn_here(fmt::format("camera '{}': the field of view {} is taken for {}", camera.name,
                            from.mHorizontalFOV, camera.vertical_fov));
    }
    scene_.cameras.push_back(camera);
  }

  // Powers have no unit in these formats: they are taken as W/sr, those of suns as W/m^2.
  void add_light(const aiLight& from, const Matrix& node) {
    const Color power(from.mColorDiffuse.r, from.mColorDiffuse.g, from.mColorDiffuse.b);
    const Vec3 position = as_vec3(from.mPosition) * node, direction = turned(as_vec3(from.mDirection), node);
    if (from.mType == aiLightSource_POINT)
      scene_.points.push_back({position, power});
    else if (from.mType == aiLightSource_DIRECTIONAL)
      scene_.suns.push_back({direction, power});
    else if (from.mType == aiLightSource_SPOT)  // cones of assimp are measured across
      scene_.spots.push_back(
          {position, direction, power, from.mAngleInnerCone / 2, from.mAngleOuterCone / 2});
    else
      warn_here(
          fmt::format("the light '{}' is neither point, spot nor sun, and is left out", from.mName.C_Str()));
  }

  Scene& scene_;
  const aiScene& from_;
  const std::vector<int>& meshes_;
  const ImportLimits& limits_;
  const std::string& file_;
  std::multimap<std::string, unsigned> cameras_, lights_;  // by the node they hang at
};

}  // namespace

void add_nodes(Scene& scene, const aiScene& from, const std::vector<int>& meshes, const Matrix& root,
               const ImportLimits& limits, const std::string& file) {
  if (from.mRootNode) Nodes(scene, from, meshes, limits, file).visit(*from.mRootNode, root, 0);
  if (from.mNumAnimations > 0) warn(scene, fmt::format("{}: animations are ignored", file));
}

}  // namespace tessera::assimp
