// SPDX-License-Identifier: Apache-2.0
// The typed arrays of a glTF file (glTF 2.0, section 3.6.2). Only for the files of this folder.
#pragma once

#include <initializer_list>
#include <vector>

#include "core/scene/gltf/document.h"

namespace tessera::gltf {

// Elements of an accessor as floats, `width` of them one after the other.
struct Floats {
  int width = 0;
  std::vector<float> values;
  std::size_t count() const { return width == 0 ? 0 : values.size() / static_cast<std::size_t>(width); }
  const float* at(std::size_t i) const { return values.data() + i * static_cast<std::size_t>(width); }
};

// Normalized integers become -1..1 or 0..1 (glTF 2.0, section 3.6.2.3); sparse accessors are filled in.
// `types` are the TINYGLTF_TYPE_ that are accepted. Throws InputError unless every byte is there.
Floats floats_of(const Document&, int accessor, std::initializer_list<int> types);

// The elements of a scalar accessor of unsigned integers, each below `end`.
std::vector<std::uint32_t> indices_of(const Document&, int accessor, std::size_t end);

// How many elements an accessor says that it has.
std::size_t count_of(const Document&, int accessor);

// `value` as it counts: an integer that is normalized becomes -1..1 or 0..1.
template <class T>
float as_float(T value, bool normalized);

}  // namespace tessera::gltf
