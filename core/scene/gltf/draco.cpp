// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/draco.h"

#include <draco/compression/decode.h>
#include <draco/core/varint_decoding.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

#include <algorithm>
#include <optional>

#include "core/scene/gltf/values.h"

namespace tessera::gltf {
namespace {

constexpr std::string_view kAccepted = "a mesh of Draco 2.2";

// A regular mesh packs well, but not better than this: faces a byte, beyond the first million.
constexpr std::uint64_t kMaxFacesPerByte = 1000, kSmallMesh = 1'000'000;

// Faces and vertices that the head of the data promises; the decoder makes room for them at once. Draco
// bitstream 2.2, "Header" and the first numbers of its two mesh encodings: by edges a byte comes first and
// vertices before faces, in sequence faces before points.
struct Promised {
  std::uint32_t faces = 0, vertices = 0;
};

std::optional<Promised> promised_by(Bytes bytes) {
  constexpr std::size_t kHead = 11;
  const std::string_view text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
  if (bytes.size() < kHead || !text.starts_with("DRACO\2\2\1")) return {};
  draco::DecoderBuffer buffer;
  buffer.Init(text.data() + kHead, text.size() - kHead, 0x0202);
  draco::GeometryMetadata ignored;
  if ((bytes[10] & 0x80) && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &ignored)) return {};
  const bool by_edges = bytes[8] == 1;
  std::uint8_t traversal = 0;
  std::uint32_t first = 0, second = 0;
  if ((by_edges && !buffer.Decode(&traversal)) || !draco::DecodeVarint(&first, &buffer) ||
      !draco::DecodeVarint(&second, &buffer))
    return {};
  return by_edges ? Promised{second, first} : Promised{first, second};
}

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
  const auto promised = promised_by(bytes);
  if (!promised) document.refuse(part_, "the Draco data has no whole head", kAccepted);
  const std::string file = document.file.string();
  require_at_most(document.limits.triangles, promised->faces, "triangles", file);
  require_at_most(document.limits.vertices, promised->vertices, "vertices", file);
  if (std::max(promised->faces, promised->vertices) > kSmallMesh + kMaxFacesPerByte * bytes.size())
    document.refuse(part_, fmt::format("{} faces and {} vertices cannot lie in {} bytes of Draco data",
                                       promised->faces, promised->vertices, bytes.size()));
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
