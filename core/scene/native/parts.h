// SPDX-License-Identifier: Apache-2.0
// The parts of a native scene file that stand for themselves: each turns one object into data or adds it.
#pragma once

#include "core/scene/native/node.h"
#include "core/scene/pictures.h"

namespace tessera {

// What the parts add to. Borrowed; outlives the call.
struct Context {
  Scene& scene;
  PictureShelf& shelf;
  bool groups_declared;  // `light_groups` is there: it names all of them
};

Camera read_camera(Context&, const Node&);
void add_light(Context&, const Node&);
Environment read_environment(Context&, const Node&);
Background read_background(const Node&);

// `group`, `diffuse` and `specular` of the node, over what `traits` is.
void override_traits(Context&, LightTraits& traits, const Node&);

// Sets the fields that the node gives, but for `first` and `second`.
void override_material(Context&, Material& material, const Node&);

// Takes a texture off, or puts one on, if the node's `key` says so.
void override_texture(Context&, Texture&, const Node& material, std::string_view key, Encoding);

// Sets the fields that the node gives, but for `material`.
void override_object(Context&, Object&, const Node&);

// The index of a new track: an array of keys.
int add_track(Scene&, const Node& keys);

// A mesh whose triangles stand in the file. The material is not looked at.
Mesh read_mesh(const std::string& name, const Node& node);

}  // namespace tessera
