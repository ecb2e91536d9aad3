// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/draco.h"

#include <draco/compression/decode.h>
#include <fmt/format.h>

#include <cstring>

#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

constexpr std::string_view kAccepted = "a mesh of Draco 2.2";

template <class T>
void append_values(const draco::PointAttribute& attribute, std::size_t points, bool normalized,
                   std::vector<float>& out) {
  for (std::size_t p = 0; p < points; ++p) {
    std::array<T, 4> element{};
    attribute.GetMappedValue(draco::PointIndex(static_cast<std::uint32_t>(p)), element.data());
    for (int c = 0; c < attribute.num_components(); ++c)
      out.push_back(as_float(element[static_cast<std::size_t>(c)], normalized));
  }
}

// The values of an attribute lie where its map says: nothing but the decoder has checked that map.
bool is_whole(const draco::PointAttribute& attribute, std::size_t points) {
  const auto stride = attribute.byte_stride(), offset = attribute.byte_offset();
  const auto element = attribute.num_components() * draco::DataTypeLength(attribute.data_type());
  if (!attribute.buffer() || element <= 0 || attribute.num_components() > 4 || offset < 0) return false;
  const auto size = static_cast<std::int64_t>(attribute.buffer()->data_size());
  if (!attribute.is_mapping_identity() && attribute.indices_map_size() < points) return false;
  for (std::size_t p = 0; p < points; ++p) {
    const auto at = static_cast<std::int64_t>(
        attribute.mapped_index(draco::PointIndex(static_cast<std::uint32_t>(p))).value());
    if (offset + at * stride + element > size) return false;
  }
  return true;
}

}  // namespace

DracoMesh::DracoMesh(const Document& document, const tinygltf::Value& extension, std::string part)
    : document_(document), extension_(extension), part_(std::move(part)) {
  const Bytes bytes = bytes_of(document, integer(extension, "bufferView").value_or(-1));
  draco::DecoderBuffer buffer;
  buffer.Init(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  std::string reason;
  try {
    auto decoded = draco::Decoder().DecodeMeshFromBuffer(&buffer);
    if (decoded.ok())
      mesh_ = std::move(decoded).value();
    else
      reason = decoded.status().error_msg_string();
  } catch (const std::exception& e) {  // of a count that no memory could hold
    reason = e.what();
  }
  if (!mesh_) document.refuse(part_, "the Draco data cannot be decoded: " + reason, kAccepted);
}

DracoMesh::~DracoMesh() = default;

bool DracoMesh::has(const std::string& attribute) const {
  const tinygltf::Value* attributes = find(extension_, "attributes");
  return attributes && integer(*attributes, attribute);
}

std::size_t DracoMesh::points() const { return mesh_->num_points(); }

Floats DracoMesh::floats(const std::string& name, bool normalized) const {
  const int id = integer(*find(extension_, "attributes"), name).value_or(-1);
  const draco::PointAttribute* attribute =
      id < 0 ? nullptr : mesh_->GetAttributeByUniqueId(static_cast<std::uint32_t>(id));
  if (!attribute || !is_whole(*attribute, points()))
    document_.refuse(part_, fmt::format("the Draco data has no whole attribute {} ({})", id, name));
  Floats floats{attribute->num_components(), {}};
  switch (attribute->data_type()) {
    case draco::DT_INT8:
      append_values<std::int8_t>(*attribute, points(), normalized, floats.values);
      break;
    case draco::DT_UINT8:
      append_values<std::uint8_t>(*attribute, points(), normalized, floats.values);
      break;
    case draco::DT_INT16:
      append_values<std::int16_t>(*attribute, points(), normalized, floats.values);
      break;
    case draco::DT_UINT16:
      append_values<std::uint16_t>(*attribute, points(), normalized, floats.values);
      break;
    case draco::DT_FLOAT32:
      append_values<float>(*attribute, points(), false, floats.values);
      break;
    default:
      document_.refuse(part_, fmt::format("the Draco attribute {} has an unfit type", name),
                       "float, or an integer of 8 or 16 bits");
  }
  return floats;
}

std::vector<std::uint32_t> DracoMesh::indices() const {
  std::vector<std::uint32_t> indices;
  indices.reserve(std::size_t{3} * mesh_->num_faces());
  for (std::uint32_t f = 0; f < mesh_->num_faces(); ++f)
    for (const draco::PointIndex& point : mesh_->face(draco::FaceIndex(f))) {
      if (point.value() >= points())
        document_.refuse(part_, fmt::format("uses vertex {} of {}", point.value(), points()));
      indices.push_back(point.value());
    }
  return indices;
}

}  // namespace tessera::gltf
