// SPDX-License-Identifier: Apache-2.0
// Path tracing with next-event estimation and multiple importance sampling (Veach 1997), 16 paths side by
// side: the pixels of one aligned 4x4 block at one sample index. A block is always traced whole, so its
// samples do not depend on which of its pixels somebody wants.
#pragma once

#include "worker/render/guides.h"

namespace tessera::tracer {

static_assert(kBlockPixels == kLanes);

class Integrator {
 public:
  // `scene` is borrowed and must outlive this.
  Integrator(const RenderScene& scene, const RenderSettings& settings, int frame);
  Integrator(const Integrator&) = delete;
  Integrator& operator=(const Integrator&) = delete;

  // Samples of index `sample`, one for each pixel of the block. Point-sampled channels come with sample 0.
  void trace(const BlockKeys& block, int sample, SampleBlock& out);

 private:
  // Where the samples in hand stand: their randomness, and how often they were scattered.
  struct Turn {
    const BlockKeys& block;
    int sample;
    const std::array<std::uint64_t, kLanes>& keys;
    std::uint32_t index;
  };

  void focus();
  void start(const Turn& turn);
  WideRay camera_rays(const Turn& turn) const;
  bool ready_vertices(const Turn& turn, int bounce);
  void first_hit(const Turn& turn, int lane, SampleBlock& out);
  void sky(int lane, SampleBlock& out);
  void catch_shadow(const Turn& turn, int lane, SampleBlock& out);
  // At the vertices in hand: sends shadow rays to lights, and the paths on. Those on Lambert's surfaces go
  // side by side and first, all else lane by lane.
  void scatter_lambert(const Turn& turn, int bounce, SampleBlock& out);
  void scatter(const Turn& turn, int lane, int bounce, SampleBlock& out);
  void go_on(int lane, const BsdfSample& s);
  void ask_lights_lambert(const Turn& turn, const Mask& here, int bounce);
  WideLightSample lights_seen(const Mask& from) const;
  void ask_light(int lane, const RayTraits& traits);
  void collect_light(int bounce, SampleBlock& out);
  void next_hits(int bounce, SampleBlock& out);
  void last_hits(int bounce, SampleBlock& out);
  void find_surfaces();
  void arrive(int lane, int bounce, SampleBlock& out);
  void find_sky(int lane, int bounce, SampleBlock& out);
  void show_unlit(int lane);
  bool survives(int lane, int bounce);
  Mask survive(const Mask& here, int bounce);
  void finish(const Turn& turn, SampleBlock& out) const;
  bool surfaces_shine() const;
  Vec2 screen(const BlockKeys& block, std::size_t lane) const;
  bool alive(int lane) const { return paths_.alive[lane] != 0; }
  void end(int lane) { paths_.alive[lane] = 0; }
  Path& path(int lane) { return paths_.lane[static_cast<std::size_t>(lane)]; }

  void ready_scattering(int lane);
  RayTraits traits(const Turn& turn, int lane, int bounce, RayKind kind) const;
  WideInt seeds(const Turn& turn, const Mask& lanes, int bounce, RayKind kind) const;
  // Light found at the end of the ray in flight, which left vertex `bounce`.
  Contribution arriving(int lane, const Emitted& found) const;
  void add(int lane, int bounce, Contribution c, SampleBlock& out);
  void add_waiting(const Mask& seen, int bounce, SampleBlock& out);
  void add_to_group(int lane, const LightTraits& traits, const Color& light, SampleBlock& out) const;
  Wide3& sum(int bounce) {
    return bounce < 0 ? paths_.emission : bounce == 0 ? paths_.direct : paths_.indirect;
  }

  const RenderScene& scene_;
  const RenderSettings& settings_;
  Views views_;
  Guides guides_;
  Color backdrop_;
  bool moving_, groups_;
  Wide rays_time_;
  Paths paths_{};
  // Random numbers: of the camera; of the vertices in hand: a point on a light, a direction, (lobe, light),
  // (roulette, -).
  RandomPairs<kLanes> pixel_, lens_, time_, light_point_, direction_, which_, roulette_;
  Packet rays_;
  ShadowPacket shadows_;
};

}  // namespace tessera::tracer
