// SPDX-License-Identifier: Apache-2.0
#include <cmath>

#include "core/error.h"
#include "core/scene/native/parts.h"

namespace tessera {

int add_track(Scene& scene, const Node& keys) {
  Track track;
  for (const Node& key : keys.items()) {
    const float time = key.number("time", 0);
    if (!track.times.empty() && !(time > track.times.back()))
      throw InputError(key.at("time").where(), "is not after the time of the key before", "rising times");
    const auto look = key.find("look_at");
    track.times.push_back(time);
    track.poses.push_back(look ? looking(*look) : read_transform(key));
    if (!(std::abs(track.poses.back().determinant()) > 0))
      throw InputError(key.where(), "shrinks to nothing", "a transform that can be undone");
  }
  scene.tracks.push_back(std::move(track));
  return static_cast<int>(scene.tracks.size()) - 1;
}

void override_object(Context& context, Object& object, const Node& node) {
  object.name = node.text("name", object.name);
  if (const auto visibility = node.find("visibility")) {
    object.camera = visibility->flag("camera", object.camera);
    object.scattered = visibility->flag("scattered", object.scattered);
    object.shadow = visibility->flag("shadow", object.shadow);
  }
  object.catcher = node.flag("shadow_catcher", object.catcher);
  if (const auto light = node.find("light")) override_traits(context, object.light, *light);
  if (const auto keys = node.find("keys")) object.track = add_track(context.scene, *keys);
}

}  // namespace tessera
