// SPDX-License-Identifier: Apache-2.0
// What a worker really does with its tasks: renders and filters. Keeps the last scenes made ready.
#pragma once

#include <cstddef>
#include <functional>
#include <memory>
#include <string>

#include "core/scene/scene.h"
#include "worker/denoise/device.h"
#include "worker/render/texture_options.h"
#include "worker/worker.h"

namespace tessera {

// Where scenes come from. Called once for a hash that is not kept, from any slot; never null, throws an
// Error. Shared, since a scene
// lives as long as the longest task that uses it.
using SceneSource = std::function<std::shared_ptr<const Scene>(const SceneRef&)>;

// Always the one scene, which is loaded already: local mode.
SceneSource scene_in_hand(std::shared_ptr<const Scene>);

// Filters on `device`. Keeps the last `scenes_kept` scenes made ready, by content hash; their textures share
// one limit of memory.
std::unique_ptr<TaskRunner> make_task_runner(SceneSource, std::unique_ptr<Device> device,
                                             std::size_t scenes_kept = 2, const TextureOptions& = {});

// The unit within which bits are promised equal: version, instruction set, and the OpenCL device with its
// driver.
std::string device_class(const std::string& version, const DeviceInfo& device);

}  // namespace tessera
