// SPDX-License-Identifier: Apache-2.0
// The typed arrays of a glTF file (glTF 2.0, section 3.6.2), read after their bounds have been checked.
#include <fmt/format.h>

#include <algorithm>
#include <cstring>

#include "core/error.h"
#include "core/scene/gltf/document.h"

namespace tessera::gltf {
namespace {

// Where the elements of an accessor lie.
struct Layout {
  const unsigned char* first = nullptr;
  std::size_t stride = 0, count = 0;
  int width = 0, component = 0;  // components an element; TINYGLTF_COMPONENT_TYPE_
  bool normalized = false;
};

Layout layout_of(const Document& document, int index) {
  const std::string part = fmt::format("accessors/{}", index);
  const auto& accessors = document.model.accessors;
  if (index < 0 || static_cast<std::size_t>(index) >= accessors.size())
    document.refuse(part, "there is no such accessor");
  const tinygltf::Accessor& accessor = accessors[static_cast<std::size_t>(index)];
  if (accessor.sparse.isSparse) document.refuse(part, "is sparse", "dense accessors");
  const int size = tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(accessor.componentType));
  const int width = tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type));
  if (size <= 0 || width <= 0) document.refuse(part, "has an unknown type");
  const std::span<const unsigned char> bytes = bytes_of(document, accessor.bufferView);
  const auto element = static_cast<std::size_t>(size) * static_cast<std::size_t>(width);
  const std::size_t declared =
      document.model.bufferViews[static_cast<std::size_t>(accessor.bufferView)].byteStride;
  const std::size_t stride = declared == 0 ? element : declared;
  if (accessor.count == 0) document.refuse(part, "has no elements");
  if (stride < element || accessor.byteOffset > bytes.size() ||
      element > bytes.size() - accessor.byteOffset ||
      accessor.count - 1 > (bytes.size() - accessor.byteOffset - element) / stride)
    document.refuse(part, fmt::format("its {} elements reach beyond the buffer view", accessor.count));
  return {bytes.data() + accessor.byteOffset,
          stride,
          accessor.count,
          width,
          accessor.componentType,
          accessor.normalized};
}

template <class T>
T loaded(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

float component(const Layout& layout, const unsigned char* element, int c) {
  const auto integer = [&](auto v) {
    const float f = static_cast<float>(v);
    return layout.normalized
               ? std::max(f / static_cast<float>(std::numeric_limits<decltype(v)>::max()), -1.0f)
               : f;
  };
  switch (layout.component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return integer(loaded<std::int8_t>(element + c));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return integer(element[c]);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return integer(loaded<std::int16_t>(element + 2 * c));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return integer(loaded<std::uint16_t>(element + 2 * c));
    default:
      return loaded<float>(element + 4 * c);
  }
}

}  // namespace

Floats floats_of(const Document& document, int index, std::initializer_list<int> types) {
  const Layout layout = layout_of(document, index);
  const std::string part = fmt::format("accessors/{}", index);
  const int type = document.model.accessors[static_cast<std::size_t>(index)].type;
  if (std::find(types.begin(), types.end(), type) == types.end())
    document.refuse(part, fmt::format("has {} components an element", layout.width));
  if (layout.component == TINYGLTF_COMPONENT_TYPE_INT ||
      layout.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ||
      layout.component == TINYGLTF_COMPONENT_TYPE_DOUBLE)
    document.refuse(part, "has an unfit component type", "float, or an integer of 8 or 16 bits");
  Floats floats{layout.width, {}};
  floats.values.reserve(layout.count * static_cast<std::size_t>(layout.width));
  for (std::size_t i = 0; i < layout.count; ++i)
    for (int c = 0; c < layout.width; ++c)
      floats.values.push_back(component(layout, layout.first + i * layout.stride, c));
  return floats;
}

std::vector<std::uint32_t> indices_of(const Document& document, int index, std::size_t end) {
  const Layout layout = layout_of(document, index);
  const std::string part = fmt::format("accessors/{}", index);
  std::vector<std::uint32_t> indices;
  if (layout.width != 1) document.refuse(part, "is no list of indices", "scalars");
  indices.reserve(layout.count);
  for (std::size_t i = 0; i < layout.count; ++i) {
    const unsigned char* at = layout.first + i * layout.stride;
    switch (layout.component) {
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        indices.push_back(*at);
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        indices.push_back(loaded<std::uint16_t>(at));
        break;
      case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        indices.push_back(loaded<std::uint32_t>(at));
        break;
      default:
        document.refuse(part, "is no list of indices", "unsigned integers");
    }
    if (indices.back() >= end)
      document.refuse(part, fmt::format("uses vertex {} of {}", indices.back(), end));
  }
  return indices;
}

}  // namespace tessera::gltf
