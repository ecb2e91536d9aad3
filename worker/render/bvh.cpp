// SPDX-License-Identifier: Apache-2.0
#include "worker/render/bvh.h"

#include <algorithm>
#include <cstring>
#include <limits>
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

// Who is asked about a hit, and what about: of the scene that is traced, so it comes with each packet.
struct Asking : RTCIntersectContext {
  const Geometry* geometry;
  const Solid* solid;
};

void check(RTCDevice device) {
  const RTCError error = rtcGetDeviceError(device);
  if (error == RTC_ERROR_NONE) return;
  if (error == RTC_ERROR_OUT_OF_MEMORY)
    throw Error(ExitCode::out_of_memory, "no memory for the acceleration structure of the scene");
  throw Error(ExitCode::internal_error, "Embree reports error " + std::to_string(error));
}

// Drops the hits that `solid` denies; Embree goes on behind them.
void drop_holes(const RTCFilterFunctionNArguments* args) {
  const Asking& asking = *static_cast<const Asking*>(args->context);
  const unsigned n = args->N;
  for (unsigned i = 0; i < n; ++i) {
    if (args->valid[i] == 0) continue;
    const unsigned instance = RTCHitN_instID(args->hit, n, i, 0);
    Hit hit{instance != RTC_INVALID_GEOMETRY_ID ? instance : RTCHitN_geomID(args->hit, n, i),
            RTCHitN_primID(args->hit, n, i), RTCHitN_u(args->hit, n, i), RTCHitN_v(args->hit, n, i)};
    const Piece::Kind kind = asking.geometry->pieces[hit.piece].kind;
    if (kind == Piece::Kind::spheres || kind == Piece::Kind::disks) {
      const float t = RTCRayN_tfar(args->ray, n, i);
      const Vec3 at(RTCRayN_org_x(args->ray, n, i) + t * RTCRayN_dir_x(args->ray, n, i),
                    RTCRayN_org_y(args->ray, n, i) + t * RTCRayN_dir_y(args->ray, n, i),
                    RTCRayN_org_z(args->ray, n, i) + t * RTCRayN_dir_z(args->ray, n, i));
      const Vec2 uv = asking.geometry->shape_uv(hit, at);
      hit.u = uv.x;
      hit.v = uv.y;
    }
    if (!(*asking.solid)(hit, RTCRayN_id(args->ray, n, i))) args->valid[i] = 0;
  }
}

Owned<RTCScene> new_scene(RTCDevice device) {
  Owned<RTCScene> scene(rtcNewScene(device));
  rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_MEDIUM);
  return scene;
}

Owned<RTCGeometry> triangles(RTCDevice device, const Geometry& geometry, std::uint32_t piece, bool placed) {
  const Mesh& mesh = geometry.mesh(piece);
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_TRIANGLE));
  void* index = rtcSetNewGeometryBuffer(g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                        sizeof(mesh.triangles[0]), mesh.triangles.size());
  check(device);
  std::memcpy(index, mesh.triangles.data(), sizeof(mesh.triangles[0]) * mesh.triangles.size());
  auto* corner = static_cast<Vec3*>(rtcSetNewGeometryBuffer(
      g.get(), RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), mesh.positions.size()));
  check(device);
  const Matrix m = geometry.step(piece, 0);
  for (std::size_t i = 0; i < mesh.positions.size(); ++i)
    corner[i] = placed ? moved(mesh.positions[i], m) : mesh.positions[i];
  return g;
}

float* vertices(RTCDevice device, RTCGeometry g, RTCFormat format, std::size_t size, std::size_t count) {
  auto* at = static_cast<float*>(rtcSetNewGeometryBuffer(g, RTC_BUFFER_TYPE_VERTEX, 0, format, size, count));
  check(device);
  return at;
}

void put(float*& at, const Vec3& p) {
  for (int k = 0; k < 3; ++k) *at++ = p[k];
}

Owned<RTCGeometry> spheres(RTCDevice device, const Scene& scene, const std::vector<std::uint32_t>& members) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_SPHERE_POINT));
  float* at = vertices(device, g.get(), RTC_FORMAT_FLOAT4, 4 * sizeof(float), members.size());
  for (const std::uint32_t i : members) {
    put(at, scene.spheres[i].center);
    *at++ = scene.spheres[i].radius;
  }
  return g;
}

Owned<RTCGeometry> quads(RTCDevice device, const Scene& scene, const std::vector<std::uint32_t>& members) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_QUAD));
  float* at = vertices(device, g.get(), RTC_FORMAT_FLOAT3, sizeof(Vec3), 4 * members.size());
  auto* index = static_cast<std::uint32_t*>(rtcSetNewGeometryBuffer(
      g.get(), RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT4, 4 * sizeof(std::uint32_t), members.size()));
  check(device);
  for (const std::uint32_t i : members) {
    const Quad& q = scene.quads[i];
    for (const Vec3& p : {q.corner, q.corner + q.edge_u, q.corner + q.edge_u + q.edge_v, q.corner + q.edge_v})
      put(at, p);
  }
  for (std::size_t i = 0; i < 4 * members.size(); ++i) index[i] = static_cast<std::uint32_t>(i);
  return g;
}

Owned<RTCGeometry> disks(RTCDevice device, const Scene& scene, const std::vector<std::uint32_t>& members) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT));
  float* at = vertices(device, g.get(), RTC_FORMAT_FLOAT4, 4 * sizeof(float), members.size());
  auto* normal = static_cast<float*>(rtcSetNewGeometryBuffer(
      g.get(), RTC_BUFFER_TYPE_NORMAL, 0, RTC_FORMAT_FLOAT3, sizeof(Vec3), members.size()));
  check(device);
  for (const std::uint32_t i : members) {
    put(at, scene.disks[i].center);
    *at++ = scene.disks[i].radius;
    put(normal, scene.disks[i].normal);
  }
  return g;
}

Owned<RTCGeometry> instance(RTCDevice device, RTCScene of, const Geometry& geometry, std::uint32_t piece) {
  Owned<RTCGeometry> g(rtcNewGeometry(device, RTC_GEOMETRY_TYPE_INSTANCE));
  rtcSetGeometryInstancedScene(g.get(), of);
  const std::size_t steps = geometry.steps(piece);
  if (steps > 1) rtcSetGeometryTimeStepCount(g.get(), static_cast<unsigned>(steps));
  for (std::size_t step = 0; step < steps; ++step) {
    const Matrix m = geometry.step(piece, step);
    float columns[12];  // of the column-vector convention, which are the rows of ours
    for (int i = 0; i < 4; ++i)
      for (int k = 0; k < 3; ++k) columns[3 * i + k] = m[i][k];
    rtcSetGeometryTransform(g.get(), static_cast<unsigned>(step), RTC_FORMAT_FLOAT3X4_COLUMN_MAJOR, columns);
  }
  return g;
}

}  // namespace

struct BvhCore::Contents {
  Owned<RTCDevice> device;
  std::vector<Owned<RTCScene>> shared;  // scenes of the meshes that are there more than once
  Owned<RTCScene> scene;
};

namespace {

// No ray meets the piece.
bool is_nowhere(const Geometry& geometry, std::uint32_t piece) {
  const Piece& p = geometry.pieces[piece];
  return p.seen_by == 0 || (p.kind == Piece::Kind::mesh && geometry.mesh(piece).triangles.empty());
}

// Makes the pieces one by one. A mesh that is there once and rests is put into the world as it is, for that
// is faster to trace; one that moves or is there more often is shared.
class Builder {
 public:
  Builder(const Geometry& geometry, const std::function<bool(int)>& masked, RTCDevice device,
          std::vector<Owned<RTCScene>>& shared)
      : geometry_(geometry),
        masked_(masked),
        device_(device),
        shared_(shared),
        uses_(geometry_.scene().meshes.size()),
        scenes_(uses_.size()) {
    for (const Instance& i : geometry_.scene().instances) ++uses_[static_cast<std::size_t>(i.mesh)];
  }

  Owned<RTCGeometry> build(std::uint32_t piece) {
    const Piece& p = geometry_.pieces[piece];
    Owned<RTCGeometry> g = p.kind == Piece::Kind::mesh ? mesh_or_instance(piece) : shapes(piece);
    if (p.seen_by != kSeenByAll) rtcSetGeometryMask(g.get(), p.seen_by);
    return g;
  }

 private:
  Owned<RTCGeometry> mesh_or_instance(std::uint32_t piece) {
    const auto index = static_cast<std::size_t>(geometry_.scene().instances[piece].mesh);
    if (uses_[index] == 1 && geometry_.steps(piece) == 1) return mesh(piece, geometry_.pieces[piece].placed);
    RTCScene& scene = scenes_[index];
    if (!scene) {
      shared_.push_back(new_scene(device_));
      scene = shared_.back().get();
      const Owned<RTCGeometry> g = mesh(piece, false);
      rtcCommitGeometry(g.get());
      rtcAttachGeometry(scene, g.get());
      rtcCommitScene(scene);
    }
    return instance(device_, scene, geometry_, piece);
  }

  Owned<RTCGeometry> mesh(std::uint32_t piece, bool placed) {
    Owned<RTCGeometry> g = triangles(device_, geometry_, piece, placed);
    if (masked_(geometry_.mesh(piece).material)) ask(g.get());
    return g;
  }

  Owned<RTCGeometry> shapes(std::uint32_t piece) {
    const Piece& p = geometry_.pieces[piece];
    const auto& members = geometry_.members[p.shapes];
    const auto make = p.kind == Piece::Kind::spheres ? spheres : p.kind == Piece::Kind::quads ? quads : disks;
    Owned<RTCGeometry> g = make(device_, geometry_.scene(), members);
    for (std::uint32_t i = 0; i < members.size(); ++i)
      if (masked_(geometry_.material({piece, i, 0, 0}))) {
        ask(g.get());
        break;
      }
    return g;
  }

  static void ask(RTCGeometry g) {
    rtcSetGeometryIntersectFilterFunction(g, drop_holes);
    rtcSetGeometryOccludedFilterFunction(g, drop_holes);
  }

  const Geometry& geometry_;
  const std::function<bool(int)>& masked_;
  RTCDevice device_;
  std::vector<Owned<RTCScene>>& shared_;
  std::vector<int> uses_;         // of each mesh
  std::vector<RTCScene> scenes_;  // of each mesh that is shared, once it is needed
};

}  // namespace

BvhCore::BvhCore(const Geometry& geometry, const std::function<bool(int)>& masked)
    : contents_(std::make_unique<Contents>()) {
  Contents& c = *contents_;
  // Builds with all threads of TBB: Embree sorts the primitives of each leaf, so that their number does not
  // show, not even in which of two coplanar surfaces is hit.
  c.device.reset(rtcNewDevice(nullptr));
  if (!c.device) throw Error(ExitCode::internal_error, "Embree does not start");
  RTCDevice device = c.device.get();
  c.scene = new_scene(device);
  Builder builder(geometry, masked, device, c.shared);
  for (std::uint32_t i = 0; i < geometry.pieces.size(); ++i) {
    if (is_nowhere(geometry, i)) continue;
    const Owned<RTCGeometry> g = builder.build(i);
    rtcCommitGeometry(g.get());
    rtcAttachGeometryByID(c.scene.get(), g.get(), i);
  }
  rtcCommitScene(c.scene.get());
  check(device);
}

BvhCore::~BvhCore() = default;

Bvh::Bvh(const Geometry& geometry, std::shared_ptr<const BvhCore> core, Solid solid)
    : core_(std::move(core)), geometry_(geometry), solid_(std::move(solid)) {}

Bvh::~Bvh() = default;

namespace {

Asking context(RTCIntersectContextFlags flags, const Geometry& geometry, const Solid& solid) {
  Asking c;
  rtcInitIntersectContext(&c);
  c.flags = flags;
  c.geometry = &geometry;
  c.solid = &solid;
  return c;
}

}  // namespace

void Bvh::intersect_coherent(Packet& packet) const {
  Asking c = context(RTC_INTERSECT_CONTEXT_FLAG_COHERENT, geometry_, solid_);
  rtcIntersect16(packet.active, core_->contents().scene.get(), &c, &packet.r);
}

void Bvh::intersect(Packet& packet) const {
  Asking c = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT, geometry_, solid_);
  rtcIntersect16(packet.active, core_->contents().scene.get(), &c, &packet.r);
}

void Bvh::occluded(ShadowPacket& packet) const {
  Asking c = context(RTC_INTERSECT_CONTEXT_FLAG_INCOHERENT, geometry_, solid_);
  rtcOccluded16(packet.active, core_->contents().scene.get(), &c, &packet.r);
}

Bvh::Bounds Bvh::bounds() const {
  RTCBounds b;
  rtcGetSceneBounds(core_->contents().scene.get(), &b);
  if (!(b.lower_x <= b.upper_x)) return {Vec3(0, 0, 0), Vec3(0, 0, 0)};
  return {{b.lower_x, b.lower_y, b.lower_z}, {b.upper_x, b.upper_y, b.upper_z}};
}

}  // namespace tessera::tracer
