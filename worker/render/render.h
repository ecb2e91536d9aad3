// SPDX-License-Identifier: Apache-2.0
// The heart of a worker: pixels of a scene as sums. Each sample is a function of (scene, settings, frame,
// pixel, sample index) and of nothing else, so any machine may render any part in any order.
#pragma once

#include <atomic>
#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "core/film.h"
#include "core/job.h"
#include "core/scene/scene.h"

namespace tessera {

namespace tracer {
class TextureCache;
class BvhCore;
class Geometry;

// Where acceleration structures come from; empty: they are built. `masked`: see bvh.h.
using CoreSource = std::function<std::shared_ptr<const BvhCore>(
    const Geometry&, const std::function<bool(int material)>& masked)>;

// Keeps the last `most`, by what they are built of: scenes that differ in materials, lights or cameras alone
// share one. Any thread.
CoreSource kept_cores(std::size_t most);
}  // namespace tracer

// A scene made ready for rays: acceleration structure, light and texture tables. Immutable, shared by
// threads.
// `cache` holds the textures, for all scenes of a process; null: one of its own. Throws Error if a texture
// cannot be read any more or the cache cannot be written.
class RenderScene;

// Ready for one frame's shutter and for the chosen variant.
std::shared_ptr<const RenderScene> prepare(std::shared_ptr<const Scene>, const RenderSettings& = {},
                                           int frame = 0,
                                           std::shared_ptr<tracer::TextureCache> cache = nullptr,
                                           const tracer::CoreSource& cores = {});

// Equal for frames and settings between which what prepare() makes of this scene is the same.
std::string preparation(const Scene&, const RenderSettings&, int frame);

// Throws Error if a texture could not be read while the scene was rendered: what was rendered is wrong.
void require_sound_textures(const RenderScene&);

struct Cancelled {};  // thrown by render() when `cancel` became true

// The sums of `samples` over `region`. The unit of work is the aligned 4x4 block at one sample index, traced
// whole; pixels outside `region` are dropped. Single-threaded; flush-to-zero is set while it runs.
Block render(const RenderScene&, const RenderSettings&, int frame, const Region& region, SampleRange samples,
             const std::atomic<bool>* cancel = nullptr);

// How many samples of a block were not finite, and are in none of its sums.
std::uint64_t dropped(const Block&);

}  // namespace tessera
