// SPDX-License-Identifier: Apache-2.0
// Scenes of a farm: their bundles are fetched from the coordinator, kept in a cache, and loaded from there.
#pragma once

#include <functional>
#include <memory>

#include "core/scene/limits.h"
#include "proto/client.h"
#include "worker/asset_cache.h"
#include "worker/task_runner.h"

namespace tessera {

// A connection of its own for each scene that is looked for: any slot may ask at any time.
using Connect = std::function<std::unique_ptr<FarmClient>()>;

// Loads the scene of SceneRef::bundle, reading no file outside of it. Throws Error(bad_input) if the scene
// has no bundle, cannot be loaded, or is not the one of SceneRef::hash; what FarmClient and AssetCache throw,
// if it does not get here. Files of the cache that are damaged are fetched again. Its files stay in the cache
// for as long as the scene lives.
SceneSource scenes_of_farm(std::shared_ptr<AssetCache>, Connect, const ImportLimits& limits = {});

}  // namespace tessera
