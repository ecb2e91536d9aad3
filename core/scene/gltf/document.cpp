// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/document.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cstring>
#include <nlohmann/json.hpp>

#include "core/error.h"
#include "core/scene/gltf/meshopt.h"
#include "core/scene/import.h"
#include "core/scene/roots.h"

namespace tessera::gltf {
namespace {

using Json = nlohmann::json;

constexpr std::size_t kMaxJson = std::size_t{1} << 30;  // tinygltf counts in 32 bits
constexpr int kMaxDepth = 64;

constexpr std::array<std::string_view, 16> kKnown{
    "EXT_mesh_gpu_instancing",    "EXT_meshopt_compression",
    "KHR_draco_mesh_compression", "KHR_lights_punctual",
    "KHR_materials_clearcoat",    "KHR_materials_emissive_strength",
    "KHR_materials_ior",          "KHR_materials_pbrSpecularGlossiness",
    "KHR_materials_sheen",        "KHR_materials_specular",
    "KHR_materials_transmission", "KHR_materials_unlit",
    "KHR_materials_variants",     "KHR_materials_volume",
    "KHR_mesh_quantization",      "KHR_texture_transform"};

bool is_known(std::string_view extension) {
  return std::find(kKnown.begin(), kKnown.end(), extension) != kKnown.end();
}

// The parsers below descend into values by recursion, and so must not meet deep ones.
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

Bytes as_bytes(std::string_view text) {
  return {reinterpret_cast<const unsigned char*>(text.data()), text.size()};
}

// The JSON and the binary chunk.
struct Chunks {
  std::string_view json, binary;
};

// Of a binary glTF (glTF 2.0, section 4.4), or all of a text one.
Chunks chunks_of(std::string_view bytes, const std::string& name) {
  if (!bytes.starts_with("glTF")) return {bytes, {}};
  const auto word = [&](std::size_t at) {
    std::uint32_t value = 0;
    std::memcpy(&value, bytes.data() + at, 4);
    return value;
  };
  if (bytes.size() < 20) throw InputError(name, "the file is cut short", "binary glTF 2.0");
  if (word(4) != 2) throw InputError(name, fmt::format("is of version {}", word(4)), "binary glTF 2.0");
  const std::size_t json = word(12);
  if (json > bytes.size() - 20) throw InputError(name, "the JSON chunk is cut short", "binary glTF 2.0");
  const std::size_t next = 20 + json;
  if (bytes.size() - next < 8) return {bytes.substr(20, json), {}};
  const std::size_t binary = word(next);
  if (binary > bytes.size() - next - 8)
    throw InputError(name, "the binary chunk is cut short", "binary glTF 2.0");
  return {bytes.substr(20, json), bytes.substr(next + 8, binary)};
}

std::string one_line(std::string text) {
  if (const auto end = text.find("] "); text.starts_with("[json.exception") && end != std::string::npos)
    text.erase(0, end + 2);
  while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.pop_back();
  std::replace(text.begin(), text.end(), '\n', ' ');
  return text;
}

// RFC 3986, section 2.1.
std::string percent_decoded(const std::string& uri) {
  std::string path;
  for (std::size_t i = 0; i < uri.size(); ++i) {
    unsigned value = 0;
    const bool coded = uri[i] == '%' && i + 2 < uri.size() &&
                       std::isxdigit(static_cast<unsigned char>(uri[i + 1])) &&
                       std::isxdigit(static_cast<unsigned char>(uri[i + 2])) &&
                       std::sscanf(uri.c_str() + i + 1, "%2x", &value) == 1;
    path += coded ? static_cast<char>(value) : uri[i];
    i += coded ? 2 : 0;
  }
  return path;
}

// Fetches buffers and images, in place of tinygltf, which would read all of them without a limit and each
// binary chunk once for every buffer.
class Fetcher {
 public:
  Fetcher(Document& document, std::string_view binary) : document_(document), binary_(binary) {}

  void fetch_buffer(const Json& buffer) {
    const std::string part = fmt::format("buffers/{}", document_.buffers.size());
    const bool first = document_.buffers.empty();
    const std::string uri = text(buffer, "uri");
    Bytes& bytes = document_.buffers.emplace_back();
    if (is_fallback(buffer)) return;
    if (!uri.empty())
      bytes = as_bytes(contents_of(uri, part));
    else if (first)
      bytes = as_bytes(binary_);
    else
      return;
    const auto length = buffer.find("byteLength");
    if (length == buffer.end() || !length->is_number_unsigned())
      document_.refuse(part, "the key 'byteLength' is missing", "a positive integer");
    if (length->get<std::uint64_t>() > bytes.size())
      document_.refuse(part, fmt::format("has {} bytes", bytes.size()),
                       fmt::format("{}, as its byteLength says", length->get<std::uint64_t>()));
    bytes = bytes.first(length->get<std::uint64_t>());
  }

  void fetch_image(const Json& image) {
    const std::string part = fmt::format("images/{}", document_.images.size());
    const std::string uri = text(image, "uri");
    Image& result = document_.images.emplace_back();
    if (tinygltf::IsDataURI(uri))
      result.bytes = as_bytes(contents_of(uri, part));
    else if (!uri.empty())
      result.file = document_.file.parent_path() / percent_decoded(uri);
    else if (const auto view = image.is_object() ? image.find("bufferView") : image.end();
             view != image.end() && view->is_number_unsigned() && view->get<std::uint64_t>() < 0x7fffffff)
      result.buffer_view = view->get<int>();
    else
      document_.refuse(part, "'uri' or 'bufferView' is missing");
  }

 private:
  static std::string text(const Json& object, const char* key) {
    const auto it = object.is_object() ? object.find(key) : object.end();
    return it != object.end() && it->is_string() ? it->get<std::string>() : std::string();
  }

  // EXT_meshopt_compression: a placeholder for bytes that are there compressed.
  static bool is_fallback(const Json& buffer) {
    if (!buffer.is_object()) return true;
    const Json::json_pointer at("/extensions/EXT_meshopt_compression/fallback");
    return buffer.contains(at) && buffer.at(at) == true;
  }

  const std::string& contents_of(const std::string& uri, const std::string& part) {
    if (!tinygltf::IsDataURI(uri)) {
      const auto file = document_.file.parent_path() / percent_decoded(uri);
      document_.read(file, fmt::format("{}#{}", document_.file.string(), part));
    } else {
      std::vector<unsigned char> decoded;
      std::string type;
      if (!tinygltf::DecodeDataURI(&decoded, type, uri, 0, false))
        document_.refuse(part, "the data URI cannot be decoded", "base64 of a known type");
      document_.storage.emplace_back(decoded.begin(), decoded.end());
    }
    document_.take(document_.storage.back().size());
    return document_.storage.back();
  }

  Document& document_;
  std::string_view binary_;
};

// tinygltf wants indices to lie in a buffer view; those that Draco compresses do not, and nobody needs them.
void drop_draco_indices(Json& root) {
  if (!root.contains("meshes") || !root["meshes"].is_array()) return;
  for (Json& mesh : root["meshes"]) {
    if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) continue;
    for (Json& primitive : mesh["primitives"])
      if (primitive.is_object() &&
          primitive.contains(Json::json_pointer("/extensions/KHR_draco_mesh_compression")))
        primitive.erase("indices");
  }
}

Json take_list(Json& root, const char* key) {
  const auto it = root.find(key);
  if (it == root.end() || !it->is_array()) return Json::array();
  Json list = std::move(*it);
  root.erase(it);
  return list;
}

void parse(Document& document, const Chunks& chunks) {
  const std::string name = document.file.string();
  std::string error, warning;
  try {
    Json root = Json::parse(chunks.json);
    if (!root.is_object()) throw InputError(name, "is no JSON object", "glTF 2.0");
    Fetcher fetcher(document, chunks.binary);
    for (const Json& buffer : take_list(root, "buffers")) fetcher.fetch_buffer(buffer);
    for (const Json& image : take_list(root, "images")) fetcher.fetch_image(image);
    drop_draco_indices(root);
    const std::string structure = root.dump(-1, ' ', false, Json::error_handler_t::replace);
    if (structure.size() > kMaxJson) throw InputError(name, "the JSON is longer than 1 GiB");
    tinygltf::TinyGLTF parser;
    if (parser.LoadASCIIFromString(&document.model, &error, &warning, structure.data(),
                                   static_cast<unsigned>(structure.size()), ""))
      return;
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    error = e.what();
  }
  throw InputError(name, error.empty() ? "cannot be parsed" : one_line(error), "glTF 2.0");
}

}  // namespace

void Document::refuse(std::string_view part, std::string_view what, std::string_view accepted) const {
  throw InputError(fmt::format("{}#{}", file.string(), part), what, accepted);
}

void Document::warn(Scene& scene, std::string_view what) const {
  tessera::warn(scene, fmt::format("{}: {}", file.string(), what));
}

void Document::warn_of_unknown(Scene& scene, const tinygltf::ExtensionMap& extensions) const {
  for (const auto& [name, value] : extensions)
    if (!is_known(name)) warn(scene, fmt::format("the extension {} is ignored", name));
}

void Document::read(const std::filesystem::path& named, std::string_view where) {
  const std::filesystem::path allowed = within(limits.roots, named, where);
  storage.push_back(read_file(allowed, limits.file_bytes - bytes, where));
  files.push_back(allowed.string());
}

void Document::take(std::uint64_t more) {
  bytes += more;
  require_at_most(limits.file_bytes, bytes, "bytes in this file and its buffers", file.string());
}

Document open(const std::filesystem::path& file, const ImportLimits& limits, std::string_view where) {
  Document document;
  document.file = file;
  document.limits = limits;
  document.read(file, where);
  document.file = document.files.front();
  document.take(document.storage.back().size());
  const Chunks chunks = chunks_of(document.storage.back(), file.string());
  check_depth(chunks.json, file.string());
  parse(document, chunks);
  for (const std::string& name : document.model.extensionsRequired)
    if (!is_known(name))
      throw InputError(file.string(), fmt::format("requires the extension '{}'", name),
                       fmt::format("{}", fmt::join(kKnown, ", ")));
  for (std::size_t v = 0; v < document.model.bufferViews.size(); ++v)
    decompress(document, static_cast<int>(v));
  return document;
}

std::size_t checked(const Document& document, int index, std::size_t size, std::string_view thing,
                    std::string_view part) {
  if (index < 0 || static_cast<std::size_t>(index) >= size)
    document.refuse(part, fmt::format("there is no {}", thing));
  return static_cast<std::size_t>(index);
}

Bytes bytes_of(const Document& document, int buffer, std::uint64_t offset, std::uint64_t length,
               std::string_view part) {
  const Bytes data = document.buffers[checked(document, buffer, document.buffers.size(),
                                              fmt::format("buffer {}", buffer), part)];
  if (offset > data.size() || length > data.size() - offset)
    document.refuse(part, "reaches beyond its buffer",
                    fmt::format("byteOffset + byteLength <= {}", data.size()));
  return data.subspan(offset, length);
}

Bytes bytes_of(const Document& document, int index) {
  const std::string part = fmt::format("bufferViews/{}", index);
  const auto& views = document.model.bufferViews;
  const tinygltf::BufferView& view = views[checked(document, index, views.size(), "such buffer view", part)];
  if (const auto it = document.decoded.find(index); it != document.decoded.end()) return as_bytes(it->second);
  return bytes_of(document, view.buffer, view.byteOffset, view.byteLength, part);
}

}  // namespace tessera::gltf
