// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation and multiple importance sampling (Veach 1997), 16 paths side by
// side: the pixels of one aligned 4x4 block at one sample index. A block is always traced whole, so its
// samples do not depend on which of its pixels somebody wants.
#pragma once

#include "core/job.h"
#include "worker/render/camera.h"
#include "worker/render/render_scene.h"
#include "worker/render/sample_sums.h"
#include "worker/render/sampler.h"

namespace tessera::tracer {

static_assert(kBlockPixels == kLanes);

// The randomness of a block's pixels.
struct BlockKeys {
  int x = 0, y = 0;  // the block's top left pixel
  std::array<std::array<std::uint64_t, kBlockPixels>, 2> half;

  BlockKeys(std::uint64_t seed, int frame, int x, int y);
};

class Integrator {
 public:
  // `scene` is borrowed and must outlive this.
  Integrator(const RenderScene& scene, const RenderSettings& settings);

  // Samples of index `sample`, one for each pixel of the block.
  void trace(const BlockKeys& block, int sample, SampleBlock& out);

 private:
  struct Path {
    Vec3 origin, direction;  // of the ray in flight
    Vertex left;             // the vertex it comes from; the origin is off its surface
    Color throughput;        // of the path so far
    float radiance_scale;    // of the refractions in throughput, of which roulette must not know
    Color direct, indirect, emission;
    Color unshadowed;  // what the shadow ray decides on
    Bsdf bsdf;
    Surface surface;
    bool alive, waits;  // waits: a shadow ray is out
  };

  void start(const BlockKeys& block, int sample);
  bool ready_vertices(const BlockKeys& block, int sample, int bounce);
  void first_hit(int lane, SampleBlock& out);
  void sky(int lane, SampleBlock& out);
  void scatter(int lane, int bounce);
  void ask_light(Path& path, int lane);
  void collect_light(int bounce);
  void next_hits(int bounce);
  void find_surfaces();
  void arrive(int lane, int bounce);
  void find_sky(Path& path, int bounce) const;
  bool survives(Path& path, int lane, int bounce) const;
  void finish(SampleBlock& out) const;
  bool gathers_emission() const;

  const RenderScene& scene_;
  CameraRays camera_;
  int max_bounces_;
  bool albedo_;
  std::array<Path, kLanes> paths_;
  // Random numbers of the vertices in hand: a point on a light, a direction, (lobe, light), (roulette, -).
  RandomPairs<kLanes> light_point_, direction_, which_, roulette_;
  Packet rays_;
  ShadowPacket shadows_;
};

}  // namespace tessera::tracer
