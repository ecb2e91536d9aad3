// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/document.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "core/error.h"
#include "core/scene/files.h"

namespace tessera::gltf {
namespace {

constexpr std::uint64_t kMaxBytes = 4000ull << 20;  // tinygltf counts in 32 bits
constexpr int kMaxDepth = 64;

// Extensions that change what the core data mean, and that we honour.
constexpr std::array<std::string_view, 7> kKnown{
    "KHR_lights_punctual",        "KHR_materials_emissive_strength",     "KHR_materials_ior",
    "KHR_materials_transmission", "KHR_materials_pbrSpecularGlossiness", "KHR_materials_unlit",
    "KHR_mesh_quantization"};

// tinygltf descends into values by recursion, and so must not meet deep ones.
void check_depth(std::string_view json, const std::string& name) {
  int depth = 0;
  bool quoted = false;
  for (std::size_t i = 0; i < json.size(); ++i) {
    const char c = json[i];
    if (quoted && c == '\\')
      ++i;
    else if (c == '"')
      quoted = !quoted;
    else if (!quoted && (c == '{' || c == '['))
      ++depth;
    else if (!quoted && (c == '}' || c == ']'))
      --depth;
    if (depth > kMaxDepth)
      throw InputError(name, fmt::format("the JSON is nested deeper than {}", kMaxDepth));
  }
}

// The JSON chunk of a binary glTF (glTF 2.0, section 4.4), or all of a text one.
std::string_view json_of(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("glTF")) return bytes;
  std::uint32_t length = 0;
  if (bytes.size() < 20) throw InputError(name, "the file is cut short", "binary glTF 2.0");
  std::memcpy(&length, bytes.data() + 12, 4);
  if (length > bytes.size() - 20) throw InputError(name, "the JSON chunk is cut short", "binary glTF 2.0");
  return bytes.substr(20, length);
}

// Keeps the bytes. Those of a buffer view are found there when they are needed, and checked then.
bool keep_encoded(tinygltf::Image* image, const int, std::string*, std::string*, int, int,
                  const unsigned char* bytes, int size, void*) {
  if (image->bufferView < 0 && size > 0) image->image.assign(bytes, bytes + size);
  return true;
}

tinygltf::FsCallbacks plain_files() {
  tinygltf::FsCallbacks files{};
  files.FileExists = [](const std::string& path, void*) {
    std::error_code error;
    return std::filesystem::is_regular_file(path, error);
  };
  files.ExpandFilePath = [](const std::string& path, void*) { return path; };
  files.ReadWholeFile = [](std::vector<unsigned char>* out, std::string* error, const std::string& path,
                           void*) {
    try {
      const std::string bytes = read_file(path, kMaxBytes);
      out->assign(bytes.begin(), bytes.end());
      return true;
    } catch (const std::exception& e) {
      if (error) *error += e.what();
      return false;
    }
  };
  return files;
}

std::string one_line(std::string text) {
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

void parse(Document& document, const std::string& bytes) {
  const std::string name = document.file.string(), folder = document.file.parent_path().string();
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_encoded, nullptr);
  parser.SetFsCallbacks(plain_files());
  std::string error, warning;
  bool ok = false;
  try {
    const auto size = static_cast<unsigned>(bytes.size());
    ok = bytes.starts_with("glTF")
             ? parser.LoadBinaryFromMemory(&document.model, &error, &warning,
                                           reinterpret_cast<const unsigned char*>(bytes.data()), size, folder)
             : parser.LoadASCIIFromString(&document.model, &error, &warning, bytes.data(), size, folder);
  } catch (const std::exception& e) {
    error = e.what();
  }
  if (!ok) throw InputError(name, error.empty() ? "cannot be parsed" : one_line(error), "glTF 2.0");
}

}  // namespace

void Document::refuse(std::string_view part, std::string_view what, std::string_view accepted) const {
  throw InputError(fmt::format("{}#{}", file.string(), part), what, accepted);
}

Document open(const std::filesystem::path& file, std::string_view where) {
  const std::string bytes = read_file(file, kMaxBytes, where);
  check_depth(json_of(bytes, file.string()), file.string());
  Document document{file, {}};
  parse(document, bytes);
  for (const std::string& name : document.model.extensionsRequired)
    if (std::find(kKnown.begin(), kKnown.end(), name) == kKnown.end())
      throw InputError(file.string(), fmt::format("requires the extension '{}'", name),
                       fmt::format("{}", fmt::join(kKnown, ", ")));
  return document;
}

std::span<const unsigned char> bytes_of(const Document& document, int index) {
  const std::string part = fmt::format("bufferViews/{}", index);
  const auto& views = document.model.bufferViews;
  if (index < 0 || static_cast<std::size_t>(index) >= views.size())
    document.refuse(part, "there is no such buffer view");
  const tinygltf::BufferView& view = views[static_cast<std::size_t>(index)];
  if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= document.model.buffers.size())
    document.refuse(part, fmt::format("there is no buffer {}", view.buffer));
  const std::vector<unsigned char>& data = document.model.buffers[static_cast<std::size_t>(view.buffer)].data;
  if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
    document.refuse(part, "reaches beyond its buffer",
                    fmt::format("byteOffset + byteLength <= {}", data.size()));
  return {data.data() + view.byteOffset, view.byteLength};
}

std::span<const unsigned char> image_bytes(const Document& document, int index) {
  const std::string part = fmt::format("images/{}", index);
  const auto& images = document.model.images;
  if (index < 0 || static_cast<std::size_t>(index) >= images.size())
    document.refuse(part, "there is no such image");
  const tinygltf::Image& image = images[static_cast<std::size_t>(index)];
  if (image.bufferView >= 0) return bytes_of(document, image.bufferView);
  if (image.image.empty())
    document.refuse(part,
                    fmt::format("{}: no such file", (document.file.parent_path() / image.uri).string()));
  return image.image;
}

}  // namespace tessera::gltf
