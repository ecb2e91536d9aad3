// SPDX-License-Identifier: Apache-2.0
// What a worker really does with its tasks: renders and filters. Keeps the last scenes made ready.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "core/scene/scene.h"
#include "worker/denoise/device_pool.h"
#include "worker/render/texture_options.h"
#include "worker/worker.h"

namespace tessera {

// Where scenes come from. Called once for a hash that is not kept, from any slot; never null, throws an
// Error. Shared, since a scene
// lives as long as the longest task that uses it.
using SceneSource = std::function<std::shared_ptr<const Scene>(const SceneRef&)>;

// Always the one scene, which is loaded already: local mode.
SceneSource scene_in_hand(std::shared_ptr<const Scene>);

// Filters on the devices, whichever is first to be done. Keeps the last `scenes_kept` scenes made ready, by
// content hash; their textures share one limit of memory.
std::unique_ptr<TaskRunner> make_task_runner(SceneSource, DevicePool devices, std::size_t scenes_kept = 2,
                                             const TextureOptions& = {});

// The unit within which bits are promised equal: version, instruction set, and the OpenCL device with its
// driver; of devices of several kinds all of them, and then nothing is promised.
std::string device_class(const std::string& version, const std::vector<DeviceInfo>& devices);

}  // namespace tessera
