// SPDX-License-Identifier: Apache-2.0
#include "core/scene/files.h"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>

#include "core/error.h"

namespace tessera {

std::string read_file(const std::filesystem::path& file, std::uint64_t most, std::string_view where) {
  const auto refuse = [&](std::string_view what, std::string_view accepted = {}) {
    if (where.empty()) throw InputError(file.string(), what, accepted);
    throw InputError(where, fmt::format("{}: {}", file.string(), what), accepted);
  };
  std::error_code error;
  const auto status = std::filesystem::status(file, error);
  if (!std::filesystem::exists(status)) refuse("no such file");
  if (!std::filesystem::is_regular_file(status)) refuse("is not a file");
  const std::uint64_t size = std::filesystem::file_size(file, error);
  if (error) refuse("cannot be read: " + error.message());
  if (size > most) refuse(fmt::format("has {} bytes", size), fmt::format("at most {}", most));
  std::string bytes(size, '\0');
  std::ifstream stream(file, std::ios::binary);
  if (!stream.read(bytes.data(), static_cast<std::streamsize>(size))) refuse("cannot be read");
  return bytes;
}

void require_at_most(std::uint64_t most, std::uint64_t count, std::string_view things,
                     std::string_view where) {
  if (count > most)
    throw InputError(where, fmt::format("there are {} {}", count, things), fmt::format("at most {}", most));
}

std::string extension_of(const std::filesystem::path& file) {
  std::string extension = file.extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension;
}

}  // namespace tessera
