// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/meshopt.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

// The densest code, of attributes, has at least two bits for sixteen bytes.
constexpr std::size_t kMaxExpansion = 64, kSmallest = 4096;

// What the extension says (EXT_meshopt_compression, "JSON schema updates"), checked.
struct Coded {
  Bytes bytes;
  std::size_t count = 0, stride = 0;
  std::string mode, filter;
};

Coded coded_of(const Document& document, const tinygltf::Value& extension, const std::string& part) {
  const auto positive = [&](const char* key, int otherwise) {
    const int value = integer(extension, key).value_or(otherwise);
    if (value < 0) document.refuse(part, fmt::format("{} is {}", key, value), "an integer of 0 or more");
    return static_cast<std::size_t>(value);
  };
  Coded coded;
  coded.bytes = bytes_of(document, integer(extension, "buffer").value_or(-1), positive("byteOffset", 0),
                         positive("byteLength", -1), part);
  coded.count = positive("count", -1);
  coded.stride = positive("byteStride", -1);
  coded.mode = text(extension, "mode").value_or("");
  coded.filter = text(extension, "filter").value_or("NONE");
  const bool attributes = coded.mode == "ATTRIBUTES";
  if (!attributes && coded.mode != "TRIANGLES" && coded.mode != "INDICES")
    document.refuse(part, fmt::format("the mode is '{}'", coded.mode), "ATTRIBUTES, TRIANGLES or INDICES");
  const std::size_t stride = coded.stride;
  const bool stride_ok =
      attributes ? stride > 0 && stride % 4 == 0 && stride <= 256 : stride == 2 || stride == 4;
  const bool filter_ok = coded.filter == "NONE" || (attributes && coded.filter == "EXPONENTIAL") ||
                         (attributes && coded.filter == "OCTAHEDRAL" && (stride == 4 || stride == 8)) ||
                         (attributes && coded.filter == "QUATERNION" && stride == 8);
  if (!stride_ok || !filter_ok || (coded.mode == "TRIANGLES" && coded.count % 3 != 0))
    document.refuse(part, fmt::format("{} elements of {} bytes with the filter {} do not go with {}",
                                      coded.count, stride, coded.filter, coded.mode));
  if (coded.count * stride > kMaxExpansion * coded.bytes.size() + kSmallest)
    document.refuse(part, fmt::format("{} elements cannot lie in {} bytes", coded.count, coded.bytes.size()));
  return coded;
}

bool decode(const Coded& from, void* to) {
  const unsigned char* bytes = from.bytes.data();
  const std::size_t size = from.bytes.size();
  if (from.mode == "TRIANGLES")
    return meshopt_decodeIndexBuffer(to, from.count, from.stride, bytes, size) == 0;
  if (from.mode == "INDICES")
    return meshopt_decodeIndexSequence(to, from.count, from.stride, bytes, size) == 0;
  if (meshopt_decodeVertexBuffer(to, from.count, from.stride, bytes, size) != 0) return false;
  if (from.filter == "OCTAHEDRAL") meshopt_decodeFilterOct(to, from.count, from.stride);
  if (from.filter == "QUATERNION") meshopt_decodeFilterQuat(to, from.count, from.stride);
  if (from.filter == "EXPONENTIAL") meshopt_decodeFilterExp(to, from.count, from.stride);
  return true;
}

}  // namespace

void decompress(Document& document, int index) {
  const std::string part = fmt::format("bufferViews/{}", index);
  const tinygltf::BufferView& view = document.model.bufferViews[static_cast<std::size_t>(index)];
  const tinygltf::Value* extension = find(view.extensions, "EXT_meshopt_compression");
  if (!extension) return;
  const Coded coded = coded_of(document, *extension, part);
  document.take(coded.count * coded.stride);
  std::string bytes(coded.count * coded.stride, '\0');
  if (!decode(coded, bytes.data())) document.refuse(part, "cannot be decoded", "EXT_meshopt_compression");
  document.decoded[index] = std::move(bytes);
}

}  // namespace tessera::gltf
