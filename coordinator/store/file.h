// SPDX-License-Identifier: Apache-2.0
// Files by descriptors, with every failure said as StoreFull or StoreError.
#pragma once

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

namespace tessera {

using Bytes = std::span<const std::byte>;
inline Bytes bytes_of(std::string_view text) { return std::as_bytes(std::span(text)); }

// Throws StoreFull if the system's `error` means that there is no room, StoreError otherwise.
[[noreturn]] void throw_store_error(const std::filesystem::path& where, std::string_view doing, int error);

class OpenFile {
 public:
  enum class Mode { read, write, create };  // write: for both, there or not; create: empty, must not be there

  OpenFile() = default;
  OpenFile(std::filesystem::path path, Mode mode);
  OpenFile(OpenFile&& other) noexcept;
  OpenFile& operator=(OpenFile&& other) noexcept;
  ~OpenFile();

  const std::filesystem::path& path() const { return path_; }
  std::uint64_t size() const;
  // Writes all of `parts`, one behind the other, from `offset`. If it fails, the file ends at `offset`.
  void write(std::uint64_t offset, std::span<const Bytes> parts);
  // As many bytes as are there, at most those of `to`.
  std::size_t read(std::uint64_t offset, std::span<std::byte> to) const;
  void truncate(std::uint64_t size);
  void sync() const;
  // Lets the system begin to write what is there, so that sync() is short.
  void begin_sync(std::uint64_t offset, std::uint64_t bytes) const;
  void close();

 private:
  std::filesystem::path path_;
  int descriptor_ = -1;
};

// Renames, and makes that last. Both lie in the same file system.
void move_file(const std::filesystem::path& from, const std::filesystem::path& to, bool sync);
// And those it lies in, for nobody else to read.
void make_folder(const std::filesystem::path& folder);
// A file, or a folder and all in it; there or not.
void remove_files(const std::filesystem::path& path);

}  // namespace tessera
