// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bvh.h"

#include <algorithm>
#include <limits>
#include <map>
#include <string>

#include "core/error.h"

namespace tessera::tracer {

struct EmbreeRelease {
  void operator()(RTCDevice d) const { rtcReleaseDevice(d); }
  void operator()(RTCScene s) const { rtcReleaseScene(s); }
  void operator()(RTCGeometry g) const { rtcReleaseGeometry(g); }
};
template <typename T>
using Owned = std::unique_ptr<std::remove_pointer_t<T>, EmbreeRelease>;

namespace {

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ExitCode::out_of_memory, "no memory for the acceleration structure of the scene");
  throw Error(ExitCode::internal_error, "Embree reports error " + std::to_string(error));
}

// Drops the hits that `solid` denies; Embree goes on behind them.
void drop_holes(const RTCFilterFunctionNArguments* args) {
  const Solid& solid = *static_cast<const Solid*>(args->geometryUserPtr);
  for (unsigned i = 0; i < args->N; ++i) {
    if (args->valid[i] == 0) continue;
    const unsigned instance = RTCHitN_instID(args->hit, args->N, i, 0);
    const Hit hit{instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(args->hit, args->N, i),
                  RTCHitN_primID(args->hit, args->N, i), RTCHitN_u(args->hit, args->N, i),
                  RTCHitN_v(args->hit, args->N, i)};
    if (!solid(hit)) args->valid[i] = 0;
  }
}

Owned<RTCScene> new_scene(RTCDevice device) {
  Owned<RTCScene> scene(rtcNewScene(device));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

Owned<RTCGeometry> triangles(RTCDevice device, const Geometry& geometry, std::uint32_t piece, bool placed) {
  const Mesh& mesh = *geometry.pieces[piece].mesh;
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  rtcSetSharedGeometryBuffer(g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3, mesh.triangles.data(), 0,
                             sizeof(mesh.triangles[0]), mesh.triangles.size());
  auto* corner = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
      g.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.positions.size()));
  check(device);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    corner[i] = placed ? geometry.to_world(piece, mesh.positions[i]) : mesh.positions[i];
  return g;
}

Owned<RTCGeometry> spheres(RTCDevice device, const std::vector<Sphere>& all) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
  auto* at = static_cast<float*>(rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_VERTEX, 0,
                                                         RTC_FORMAT_FLOAT4, 4 * sizeof(float), all.size()));
  check(device);
  for (const Sphere& s : all) {
    for (int k = 0; k < 3; ++k) *at++ = s.center[k];
    *at++ = s.radius;
  }
  return g;
}

Owned<RTCGeometry> instance(RTCDevice device, RTCScene of, const Matrix& m) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(g.get(), of);
  float columns[12];  // of the column-vector convention, which are the rows of ours
  for (int i = 0; i < 4; ++i)
    for (int k = 0; k < 3; ++k) columns[3 * i + k] = m[i][k];
  rtcSetGeometryTransform(g.get(), 0, RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  return g;
}

}  // namespace

struct Bvh::Contents {
  Solid solid;
  Owned<RTCDevice> device;
  std::vector<Owned<RTCScene>> shared;  // scenes of the meshes that are there more than once
  Owned<RTCScene> scene;
};

namespace {

// Adds the pieces one by one. A mesh that is there once is put into the world as it is, for that is faster
// to trace; one that is there more often is shared.
class Builder {
 public:
  Builder(const Geometry& geometry, const std::function<bool(int)>& masked, const Solid& solid,
          RTCDevice device, std::vector<Owned<RTCScene>>& shared)
      : geometry_(geometry), masked_(masked), solid_(solid), device_(device), shared_(shared) {
    for (const Piece& p : geometry.pieces)
      if (p.mesh) ++uses_[p.mesh];
  }

  Owned<RTCGeometry> build(std::uint32_t piece) {
    const Piece& p = geometry_.pieces[piece];
    if (uses_[p.mesh] == 1) return mesh(piece, p.placed);
    auto [at, is_new] = scenes_.try_emplace(p.mesh, nullptr);
    if (is_new) {
      shared_.push_back(new_scene(device_));
      at->second = shared_.back().get();
      Owned<RTCGeometry> g = mesh(piece, false);
      rtcCommitGeometry(g.get());
      rtcAttachGeometry(at->second, g.get());
      rtcCommitScene(at->second);
    }
    return instance(device_, at->second, p.to_world);
  }

 private:
  Owned<RTCGeometry> mesh(std::uint32_t piece, bool placed) {
    Owned<RTCGeometry> g = triangles(device_, geometry_, piece, placed);
    if (masked_(geometry_.pieces[piece].mesh->material)) {
      rtcSetGeometryUserData(g.get(), const_cast<Solid*>(&solid_));
      rtcSetGeometryIntersectFilterFunction(g.get(), drop_holes);
      rtcSetGeometryOccludedFilterFunction(g.get(), drop_holes);
    }
    return g;
  }

  const Geometry& geometry_;
  const std::function<bool(int)>& masked_;
  const Solid& solid_;
  RTCDevice device_;
  std::vector<Owned<RTCScene>>& shared_;
  std::map<const Mesh*, int> uses_;
  std::map<const Mesh*, RTCScene> scenes_;
};

}  // namespace

Bvh::Bvh(const Geometry& geometry, const std::function<bool(int)>& masked, Solid solid)
    : contents_(new Contents{std::move(solid), nullptr, {}, nullptr}) {
  Contents& c = *contents_;
  // Builds with all threads of TBB: Embree sorts the primitives of each leaf, so that their number does not
  // show, not even in which of two coplanar surfaces is hit.
  c.device.reset(rtcNewDevice(nullptr));
  if (!c.device) throw Error(ExitCode::internal_error, "Embree does not start");
  RTCDevice device = c.device.get();
  c.scene = new_scene(device);
  Builder builder(geometry, masked, c.solid, device, c.shared);
  const auto add = [&](const Owned<RTCGeometry>& g, std::size_t id) {
    rtcCommitGeometry(g.get());
    rtcAttachGeometryByID(c.scene.get(), g.get(), static_cast<unsigned>(id));
  };
  for (std::size_t i = 0; i < geometry.sphere_piece(); ++i)
    if (!geometry.pieces[i].mesh->triangles.empty()) add(builder.build(static_cast<std::uint32_t>(i)), i);
  if (!geometry.scene().spheres.empty())
    add(spheres(device, geometry.scene().spheres), geometry.sphere_piece());
  rtcCommitScene(c.scene.get());
  check(device);
}

Bvh::~Bvh() = default;

namespace {

RTCIntersectContext context(RTCIntersectContextFlags flags) {
  RTCIntersectContext c;
  rtcInitIntersectContext(&c);
  c.flags = flags;
  return c;
}

}  // namespace

void Bvh::intersect_coherent(Packet& packet) const {
  RTCIntersectContext c = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT);
  rtcIntersect16(packet.active, contents_->scene.get(), &c, &packet.r);
}

void Bvh::intersect(Packet& packet) const {
  RTCIntersectContext c = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcIntersect16(packet.active, contents_->scene.get(), &c, &packet.r);
}

void Bvh::occluded(ShadowPacket& packet) const {
  RTCIntersectContext c = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT);
  rtcOccluded16(packet.active, contents_->scene.get(), &c, &packet.r);
}

Bvh::Bounds Bvh::bounds() const {
  RTCBounds b;
  rtcGetSceneBounds(contents_->scene.get(), &b);
  if (!(b.lower_x <= b.upper_x)) return {Vec3(0, 0, 0), Vec3(0, 0, 0)};
  return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
}

}  // namespace tessera::tracer
