// SPDX-License-Identifier: Apache-2.0
// Small PLY and FBX files.
#pragma once

#include <cstring>
#include <string>
#include <vector>

#include "tests/core/scene/folder.h"

namespace tessera {

// A square, red where x is 1 and green where y is 1.
inline const std::string kPlyHeader =
    "element vertex 4\nproperty float x\nproperty float y\nproperty float z\nproperty uchar red\n"
    "property uchar green\nproperty uchar blue\nelement face 1\nproperty list uchar int vertex_indices\n"
    "end_header\n";
inline const std::string kTextPly = "ply\nformat ascii 1.0\n" + kPlyHeader +
                                    "0 0 0 0 0 0\n1 0 0 255 0 0\n1 1 0 255 188 0\n0 1 0 0 188 0\n4 0 1 2 3\n";

template <class T>
void append_bytes(std::string& to, const T& value) {
  to.append(reinterpret_cast<const char*>(&value), sizeof value);
}

inline std::string binary_ply() {
  std::string ply = "ply\nformat binary_little_endian 1.0\n" + kPlyHeader;
  for (const auto& [x, y] : {std::pair{0, 0}, {1, 0}, {1, 1}, {0, 1}}) {
    append_bytes(ply, static_cast<float>(x));
    append_bytes(ply, static_cast<float>(y));
    append_bytes(ply, 0.0f);
    ply += {static_cast<char>(255 * x), static_cast<char>(188 * y), '\0'};
  }
  ply += '\4';
  for (const std::int32_t v : {0, 1, 2, 3}) append_bytes(ply, v);
  return ply;
}

// A record of a binary FBX of version 7400: a name, properties that are encoded already, records in it.
struct FbxRecord {
  std::string name;
  std::vector<std::string> properties;
  std::vector<FbxRecord> records = {};
};

inline std::string fbx_text(const std::string& text) {
  std::string bytes = "S";
  append_bytes(bytes, static_cast<std::uint32_t>(text.size()));
  return bytes + text;
}

template <class T>
std::string fbx_value(char type, T value) {
  std::string bytes(1, type);
  append_bytes(bytes, value);
  return bytes;
}

template <class T>
std::string fbx_array(char type, const std::vector<T>& values) {
  std::string bytes(1, type);
  const auto size = static_cast<std::uint32_t>(values.size() * sizeof(T));
  for (const std::uint32_t word : {static_cast<std::uint32_t>(values.size()), 0u, size})
    append_bytes(bytes, word);
  return bytes + std::string(reinterpret_cast<const char*>(values.data()), size);
}

inline void append_record(std::string& file, const FbxRecord& record) {
  const std::size_t start = file.size();
  std::string properties;
  for (const std::string& p : record.properties) properties += p;
  for (const std::size_t word : {std::size_t{0}, record.properties.size(), properties.size()})
    append_bytes(file, static_cast<std::uint32_t>(word));
  file += static_cast<char>(record.name.size());
  file += record.name + properties;
  for (const FbxRecord& inner : record.records) append_record(file, inner);
  if (!record.records.empty()) file.append(13, '\0');
  const auto end = static_cast<std::uint32_t>(file.size());
  std::memcpy(file.data() + start, &end, 4);
}

// A triangle with a picture in the file.
inline std::string binary_fbx() {
  const auto id = [](std::int64_t v) { return fbx_value('L', v); };
  const auto name = [](const std::string& what, const std::string& kind) {
    return fbx_text(what + std::string("\0\1", 2) + kind);
  };
  const auto join = [&](std::int64_t child, std::int64_t parent) {
    return FbxRecord{"C", {fbx_text("OO"), id(child), id(parent)}};
  };
  const std::string image = contents(kData / "corners.png");
  std::string content = "R";
  append_bytes(content, static_cast<std::uint32_t>(image.size()));
  content += image;
  const FbxRecord geometry{
      "Geometry",
      {id(10), name("t", "Geometry"), fbx_text("Mesh")},
      {{"Vertices", {fbx_array<double>('d', {0, 0, 0, 100, 0, 0, 0, 100, 0})}},
       {"PolygonVertexIndex", {fbx_array<std::int32_t>('i', {0, 1, -3})}},
       {"LayerElementMaterial",
        {fbx_value('I', 0)},
        {{"MappingInformationType", {fbx_text("AllSame")}},
         {"ReferenceInformationType", {fbx_text("IndexToDirect")}},
         {"Materials", {fbx_array<std::int32_t>('i', {0})}}}},
       {"Layer",
        {fbx_value('I', 0)},
        {{"LayerElement",
          {},
          {{"Type", {fbx_text("LayerElementMaterial")}}, {"TypedIndex", {fbx_value('I', 0)}}}}}}}};
  const FbxRecord model{
      "Model", {id(20), name("t", "Model"), fbx_text("Mesh")}, {{"Version", {fbx_value('I', 232)}}}};
  const FbxRecord material{
      "Material", {id(30), name("m", "Material"), fbx_text("")}, {{"ShadingModel", {fbx_text("lambert")}}}};
  const FbxRecord texture{
      "Texture",
      {id(40), name("x", "Texture"), fbx_text("")},
      {{"FileName", {fbx_text("corners.png")}}, {"RelativeFilename", {fbx_text("corners.png")}}}};
  const FbxRecord video{"Video",
                        {id(50), name("x", "Video"), fbx_text("Clip")},
                        {{"FileName", {fbx_text("corners.png")}},
                         {"RelativeFilename", {fbx_text("corners.png")}},
                         {"Content", {content}}}};
  std::string file("Kaydara FBX Binary  \0\x1a\0", 23);
  append_bytes(file, std::uint32_t{7400});
  append_record(file, {"FBXHeaderExtension", {}, {{"FBXVersion", {fbx_value('I', 7400)}}}});
  append_record(file, {"Objects", {}, {geometry, model, material, texture, video}});
  append_record(file, {"Connections",
                       {},
                       {join(20, 0),
                        join(10, 20),
                        join(30, 20),
                        {"C", {fbx_text("OP"), id(40), id(30), fbx_text("DiffuseColor")}},
                        join(50, 40)}});
  file.append(13, '\0');
  return file;
}

// Two models of one square, a light and a camera, in decimetres, +Z up.
inline const std::string kTextFbx = R"(; FBX 7.4.0 project file
FBXHeaderExtension:  {
 FBXHeaderVersion: 1003
 FBXVersion: 7400
 Creator: "hand"
}
GlobalSettings:  {
 Version: 1000
 Properties70:  {
  P: "UpAxis", "int", "Integer", "",2
  P: "UpAxisSign", "int", "Integer", "",1
  P: "FrontAxis", "int", "Integer", "",1
  P: "FrontAxisSign", "int", "Integer", "",-1
  P: "CoordAxis", "int", "Integer", "",0
  P: "CoordAxisSign", "int", "Integer", "",1
  P: "UnitScaleFactor", "double", "Number", "",10
 }
}
Definitions:  {
 Version: 100
 Count: 5
}
Objects:  {
 Geometry: 10, "Geometry::card", "Mesh" {
  Vertices: *12 {
   a: 0,0,0,10,0,0,10,0,20,0,0,20
  }
  PolygonVertexIndex: *4 {
   a: 0,1,2,-4
  }
  GeometryVersion: 124
  LayerElementMaterial: 0 {
   Version: 101
   Name: ""
   MappingInformationType: "AllSame"
   ReferenceInformationType: "IndexToDirect"
   Materials: *1 {
    a: 0
   }
  }
  Layer: 0 {
   Version: 100
   LayerElement:  {
    Type: "LayerElementMaterial"
    TypedIndex: 0
   }
  }
 }
 Model: 20, "Model::panel", "Mesh" {
  Version: 232
  Properties70:  {
   P: "Lcl Translation", "Lcl Translation", "", "A",100,0,0
  }
 }
 Model: 21, "Model::again", "Mesh" {
  Version: 232
  Properties70:  {
   P: "Lcl Scaling", "Lcl Scaling", "", "A",2,2,2
  }
 }
 Material: 30, "Material::red", "" {
  Version: 102
  ShadingModel: "phong"
  Properties70:  {
   P: "DiffuseColor", "Color", "", "A",0.5,0.25,1
   P: "EmissiveColor", "Color", "", "A",0,2,0
   P: "SpecularColor", "Color", "", "A",0.5,0.5,0.5
   P: "ShininessExponent", "double", "Number", "",30
   P: "SpecularFactor", "double", "Number", "",1
   P: "Opacity", "double", "Number", "",0.5
  }
 }
 NodeAttribute: 40, "NodeAttribute::lamp", "Light" {
  Properties70:  {
   P: "LightType", "enum", "", "",0
   P: "Color", "Color", "", "A",1,0.5,0.25
   P: "Intensity", "Number", "", "A",400
  }
  TypeFlags: "Light"
 }
 Model: 41, "Model::lamp", "Light" {
  Version: 232
  Properties70:  {
   P: "Lcl Translation", "Lcl Translation", "", "A",0,0,50
  }
 }
 NodeAttribute: 50, "NodeAttribute::eye", "Camera" {
  Properties70:  {
   P: "FieldOfView", "FieldOfView", "", "A",60
  }
  TypeFlags: "Camera"
 }
 Model: 51, "Model::eye", "Camera" {
  Version: 232
  Properties70:  {
   P: "Lcl Translation", "Lcl Translation", "", "A",0,-30,0
  }
 }
}
Connections:  {
 C: "OO",20,0
 C: "OO",21,0
 C: "OO",10,20
 C: "OO",10,21
 C: "OO",30,20
 C: "OO",30,21
 C: "OO",41,0
 C: "OO",40,41
 C: "OO",51,0
 C: "OO",50,51
}
)";

}  // namespace tessera
