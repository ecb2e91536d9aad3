// SPDX-License-Identifier: Apache-2.0
// A square as glTF that meshoptimizer or Draco has packed.
#pragma once

#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <meshoptimizer.h>

#include "tests/core/scene/gltf_builder.h"

namespace tessera {

inline std::string meshopt_packed(const void* vertices, std::size_t count, std::size_t stride) {
  std::string packed(meshopt_encodeVertexBufferBound(count, stride), '\0');
  packed.resize(meshopt_encodeVertexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                           vertices, count, stride));
  return packed;
}

// A view under EXT_meshopt_compression, over a placeholder buffer.
inline int meshopt_view(GltfBuilder& built, const std::string& packed, int count, int stride,
                        const char* mode, const char* filter) {
  built.json["extensionsRequired"] = {"EXT_meshopt_compression"};
  const int view = built.view(packed);
  nlohmann::json& item = built.json["bufferViews"][static_cast<std::size_t>(view)];
  item["extensions"]["EXT_meshopt_compression"] = {{"buffer", 0},
                                                   {"byteOffset", item["byteOffset"]},
                                                   {"byteLength", packed.size()},
                                                   {"count", count},
                                                   {"byteStride", stride},
                                                   {"mode", mode},
                                                   {"filter", filter}};
  item["buffer"] = 1;
  item["byteOffset"] = 0;
  item["byteLength"] = count * stride;
  built.json["buffers"] = {{{"byteLength", built.binary.size()}}, {{"byteLength", 1 << 20}}};
  return view;
}

// Positions and triangles are packed.
inline GltfBuilder meshopt_square() {
  const float corners[12] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0};
  const unsigned triangles[6] = {0, 1, 2, 0, 2, 3};
  std::string packed(meshopt_encodeIndexBufferBound(6, 4), '\0');
  packed.resize(meshopt_encodeIndexBuffer(reinterpret_cast<unsigned char*>(packed.data()), packed.size(),
                                          triangles, 6));
  GltfBuilder built;
  const int vertices = meshopt_view(built, meshopt_packed(corners, 4, 12), 4, 12, "ATTRIBUTES", "NONE");
  const int faces = meshopt_view(built, packed, 6, 2, "TRIANGLES", "NONE");
  const int positions = built.add(
      "accessors", {{"bufferView", vertices}, {"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  const int indices = built.add(
      "accessors", {{"bufferView", faces}, {"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
  built.json["nodes"] = {
      {{"mesh", built.mesh({{"attributes", {{"POSITION", positions}}}, {"indices", indices}})}}};
  return built;
}

// u of its texture coordinates is (x + x y) / 2; its accessors have no views.
inline GltfBuilder draco_square() {
  const float corners[6][3] = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  const float uvs[6][2] = {{0, 0}, {0.5f, 0}, {1, 1}, {0, 0}, {1, 1}, {0, 1}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(2);
  const int position = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  const int uv = builder.AddAttribute(draco::GeometryAttribute::TEX_COORD, 2, draco::DT_FLOAT32);
  for (int f = 0; f < 2; ++f) {
    builder.SetAttributeValuesForFace(position, draco::FaceIndex(f), corners[3 * f], corners[3 * f + 1],
                                      corners[3 * f + 2]);
    builder.SetAttributeValuesForFace(uv, draco::FaceIndex(f), uvs[3 * f], uvs[3 * f + 1], uvs[3 * f + 2]);
  }
  const auto mesh = builder.Finalize();
  draco::EncoderBuffer packed;
  draco::Encoder encoder;
  encoder.EncodeMeshToBuffer(*mesh, &packed);
  GltfBuilder built;
  built.json["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  const int view = built.view({packed.data(), packed.size()});
  built.add("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC3"}});
  built.add("accessors", {{"componentType", 5126}, {"count", 4}, {"type", "VEC2"}});
  built.add("accessors", {{"componentType", 5123}, {"count", 6}, {"type", "SCALAR"}});
  const nlohmann::json ids = {{"POSITION", mesh->attribute(position)->unique_id()},
                              {"TEXCOORD_0", mesh->attribute(uv)->unique_id()}};
  built.json["nodes"] = {
      {{"mesh",
        built.mesh({{"attributes", {{"POSITION", 0}, {"TEXCOORD_0", 1}}},
                    {"indices", 2},
                    {"extensions",
                     {{"KHR_draco_mesh_compression", {{"bufferView", view}, {"attributes", ids}}}}}})}}};
  return built;
}

}  // namespace tessera
