// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/accessor.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstring>
#include <limits>

namespace tessera::gltf {
namespace {

// Where elements lie.
struct Layout {
  const unsigned char* first = nullptr;
  std::size_t stride = 0, count = 0;
  int width = 0, component = 0;  // components an element; TINYGLTF_COMPONENT_TYPE_
  bool normalized = false;

  std::size_t element() const {
    return static_cast<std::size_t>(width) *
           static_cast<std::size_t>(tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(component)));
  }
};

std::string part_of(int index) { return fmt::format("accessors/{}", index); }

const tinygltf::Accessor& accessor_of(const Document& document, int index) {
  const auto& all = document.model.accessors;
  return all[checked(document, index, all.size(), "such accessor", part_of(index))];
}

// Points `layout` at the bytes from `offset` on of a buffer view, once all its elements are known to be
// there.
void lay_out(Layout& layout, const Document& document, int view, std::size_t offset, std::size_t stride,
             const std::string& part) {
  const Bytes bytes = bytes_of(document, view);
  const std::size_t element = layout.element();
  layout.stride = stride == 0 ? element : stride;
  if (layout.stride < element || offset > bytes.size() || element > bytes.size() - offset ||
      layout.count - 1 > (bytes.size() - offset - element) / layout.stride)
    document.refuse(part, fmt::format("its {} elements reach beyond the buffer view", layout.count));
  layout.first = bytes.data() + offset;
}

// Without bytes if the accessor has none: all its elements are 0.
Layout layout_of(const Document& document, int index) {
  const std::string part = part_of(index);
  const tinygltf::Accessor& accessor = accessor_of(document, index);
  Layout layout{nullptr,
                0,
                accessor.count,
                tinygltf::GetNumComponentsInType(static_cast<std::uint32_t>(accessor.type)),
                accessor.componentType,
                accessor.normalized};
  if (tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(layout.component)) <= 0 ||
      layout.width <= 0)
    document.refuse(part, "has an unknown type");
  if (accessor.count == 0) document.refuse(part, "has no elements");
  if (accessor.bufferView < 0) {
    require_at_most(document.limits.vertices, accessor.count, "elements",
                    fmt::format("{}#{}", document.file.string(), part));
    return layout;
  }
  const auto view = static_cast<std::size_t>(accessor.bufferView);
  const auto& views = document.model.bufferViews;
  lay_out(layout, document, accessor.bufferView, accessor.byteOffset,
          view < views.size() ? views[view].byteStride : 0, part);
  return layout;
}

template <class T>
T loaded(const unsigned char* at) {
  T value;
  std::memcpy(&value, at, sizeof value);
  return value;
}

float component(const Layout& layout, const unsigned char* element, int c) {
  switch (layout.component) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
      return as_float(loaded<std::int8_t>(element + c), layout.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      return as_float(element[c], layout.normalized);
    case TINYGLTF_COMPONENT_TYPE_SHORT:
      return as_float(loaded<std::int16_t>(element + 2 * c), layout.normalized);
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      return as_float(loaded<std::uint16_t>(element + 2 * c), layout.normalized);
    default:
      return loaded<float>(element + 4 * c);
  }
}

std::uint32_t index_at(const Document& document, const Layout& layout, std::size_t i, std::size_t end,
                       const std::string& part) {
  const unsigned char* at = layout.first + i * layout.stride;
  std::uint32_t value = 0;
  switch (layout.component) {
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
      value = *at;
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
      value = loaded<std::uint16_t>(at);
      break;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
      value = loaded<std::uint32_t>(at);
      break;
    default:
      document.refuse(part, "is no list of indices", "unsigned integers");
  }
  if (value >= end) document.refuse(part, fmt::format("uses vertex {} of {}", value, end));
  return value;
}

// The elements that a sparse accessor gives in place of those below it (glTF 2.0, section 3.6.2.3).
void fill_in(const Document& document, int index, const Layout& dense, Floats& floats) {
  const auto& sparse = accessor_of(document, index).sparse;
  const std::string part = part_of(index) + "/sparse";
  if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > dense.count)
    document.refuse(part, fmt::format("has {} elements", sparse.count), fmt::format("1 to {}", dense.count));
  if (sparse.indices.byteOffset < 0 || sparse.values.byteOffset < 0)
    document.refuse(part, "has a negative byteOffset");
  const auto count = static_cast<std::size_t>(sparse.count);
  Layout places{nullptr, 0, count, 1, sparse.indices.componentType, false}, values = dense;
  values.count = count;
  if (tinygltf::GetComponentSizeInBytes(static_cast<std::uint32_t>(places.component)) <= 0)
    document.refuse(part, "has indices of an unknown type");
  lay_out(places, document, sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset), 0,
          part);
  lay_out(values, document, sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset), 0,
          part);
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t place = index_at(document, places, i, dense.count, part);
    for (int c = 0; c < dense.width; ++c)
      floats.values[place * static_cast<std::size_t>(dense.width) + static_cast<std::size_t>(c)] =
          component(values, values.first + i * values.stride, c);
  }
}

}  // namespace

template <class T>
float as_float(T value, bool normalized) {
  const float f = static_cast<float>(value);
  if (!normalized || !std::numeric_limits<T>::is_integer) return f;
  return std::max(f / static_cast<float>(std::numeric_limits<T>::max()), -1.0f);
}
template float as_float(std::int8_t, bool);
template float as_float(std::uint8_t, bool);
template float as_float(std::int16_t, bool);
template float as_float(std::uint16_t, bool);
template float as_float(float, bool);

std::size_t count_of(const Document& document, int index) { return accessor_of(document, index).count; }

Floats floats_of(const Document& document, int index, std::initializer_list<int> types) {
  const Layout layout = layout_of(document, index);
  const std::string part = part_of(index);
  const tinygltf::Accessor& accessor = accessor_of(document, index);
  if (std::find(types.begin(), types.end(), accessor.type) == types.end())
    document.refuse(part, fmt::format("has {} components an element", layout.width));
  if (layout.component == TINYGLTF_COMPONENT_TYPE_INT ||
      layout.component == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT ||
      layout.component == TINYGLTF_COMPONENT_TYPE_DOUBLE)
    document.refuse(part, "has an unfit component type", "float, or an integer of 8 or 16 bits");
  const std::size_t size = layout.count * static_cast<std::size_t>(layout.width);
  Floats floats{layout.width, {}};
  if (!layout.first) floats.values.resize(size);
  floats.values.reserve(size);
  for (std::size_t i = 0; layout.first && i < layout.count; ++i)
    for (int c = 0; c < layout.width; ++c)
      floats.values.push_back(component(layout, layout.first + i * layout.stride, c));
  if (accessor.sparse.isSparse) fill_in(document, index, layout, floats);
  return floats;
}

std::vector<std::uint32_t> indices_of(const Document& document, int index, std::size_t end) {
  const Layout layout = layout_of(document, index);
  const std::string part = part_of(index);
  if (layout.width != 1) document.refuse(part, "is no list of indices", "scalars");
  if (!layout.first || accessor_of(document, index).sparse.isSparse)
    document.refuse(part, "is a sparse list of indices", "a dense one");
  std::vector<std::uint32_t> indices(layout.count);
  for (std::size_t i = 0; i < layout.count; ++i) indices[i] = index_at(document, layout, i, end, part);
  return indices;
}

}  // namespace tessera::gltf
