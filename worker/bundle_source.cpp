// SPDX-License-Identifier: Apache-2.0
#include "worker/bundle_source.h"

#include <fmt/format.h>

#include <optional>

#include "core/error.h"
#include "core/scene/load.h"

namespace tessera {
namespace {

struct Kept {
  OpenBundle files;  // in use: textures are read while the scene is rendered
  Scene scene;
};

std::shared_ptr<Kept> load(const OpenBundle& files, const SceneRef& ref, ImportLimits limits) {
  limits.roots = {files.files};
  auto kept = std::make_shared<Kept>(Kept{files, load_scene(files.scene(), limits)});
  if (const std::string hash = content_hash(kept->scene); hash != ref.hash)
    throw InputError(fmt::format("bundle {}", ref.bundle),
                     fmt::format("'{}' loads as the scene {}", files.bundle.scene, hash),
                     fmt::format("{}, which the job was made for", ref.hash));
  return kept;
}

}  // namespace

SceneSource scenes_of_farm(std::shared_ptr<AssetCache> cache, Connect connect, const ImportLimits& limits) {
  return [cache = std::move(cache), connect = std::move(connect),
          limits](const SceneRef& ref) -> std::shared_ptr<const Scene> {
    if (!is_digest(ref.bundle))
      throw InputError(ref.path, "the scene is not in a bundle", "scenes that were handed in to the farm");
    std::unique_ptr<FarmClient> farm;  // connected when something is missing
    const FetchBlob fetch = [&](const Digest& blob, const std::filesystem::path& file) {
      if (!farm) farm = connect();
      farm->download(blob, file);
    };
    const OpenBundle files = cache->open(ref.bundle, fetch);
    std::shared_ptr<Kept> kept;
    try {
      kept = load(files, ref, limits);
    } catch (const InputError&) {
      if (cache->repair(files, fetch) == 0) throw;  // it is not the cache's fault
      kept = load(files, ref, limits);
    }
    return {kept, &kept->scene};
  };
}

}  // namespace tessera
