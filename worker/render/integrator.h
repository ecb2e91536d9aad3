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
  bool ready_vertices(const Turn& turn, int bounce);
  void first_hit(const Turn& turn, int lane, SampleBlock& out);
  void sky(int lane, SampleBlock& out);
  void catch_shadow(const Turn& turn, int lane, SampleBlock& out);
  void scatter(const Turn& turn, int lane, int bounce, SampleBlock& out);
  void go_on(Path& path, const BsdfSample& s) const;
  void ask_light(Path& path, int lane);
  void collect_light(int bounce, SampleBlock& out);
  void next_hits(int bounce, SampleBlock& out);
  void last_hits(int bounce, SampleBlock& out);
  void find_surfaces();
  void arrive(int lane, int bounce, SampleBlock& out);
  void find_sky(Path& path, int lane, int bounce, SampleBlock& out) const;
  void show_unlit(Path& path) const;
  bool survives(Path& path, int lane, int bounce) const;
  void finish(const Turn& turn, SampleBlock& out) const;
  bool surfaces_shine() const;
  Vec2 screen(const BlockKeys& block, std::size_t lane) const;

  void ready_bsdf(Path& path) const;
  RayTraits traits(const Turn& turn, int lane, int bounce, RayKind kind) const;
  // Light found at the end of the ray in flight, which left vertex `bounce`.
  Contribution arriving(const Path& path, const Emitted& found) const;
  void add(Path& path, int lane, int bounce, Contribution c, SampleBlock& out) const;

  const RenderScene& scene_;
  const RenderSettings& settings_;
  Views views_;
  Guides guides_;
  Color backdrop_;
  bool moving_, groups_;
  std::array<Path, kLanes> paths_;
  // Random numbers: of the camera; of the vertices in hand: a point on a light, a direction, (lobe, light),
  // (roulette, -).
  RandomPairs<kLanes> pixel_, lens_, time_, light_point_, direction_, which_, roulette_;
  Packet rays_;
  ShadowPacket shadows_;
};

}  // namespace tessera::tracer
