// SPDX-License-Identifier: Apache-2.0
// A file that is fetched piece by piece, from its beginning: it appears whole and with the right bytes, or
// not at all, and what is there of it stays there when the program ends. As `file`.part, by one object at a
// time; others that want the same file meanwhile begin one of their own, which is not kept.
// Locked (flock) while it is written.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string_view>

#include "core/sha256.h"

namespace tessera {

class PartFile {
 public:
  // Its folder must be there. Throws Error if it cannot be opened or read.
  explicit PartFile(std::filesystem::path file);
  PartFile(const PartFile&) = delete;
  PartFile& operator=(const PartFile&) = delete;
  ~PartFile();

  std::uint64_t size() const { return size_; }  // bytes that are there
  // Throws Error that says why, if they cannot be written: the disk may be full.
  void append(std::string_view bytes);
  // Begins anew.
  void clear();
  // Renames it to `file`, replacing what was there, if its bytes have this digest; else removes it and
  // returns false. The end: nothing else may be called after it.
  bool commit(const Digest& digest);

 private:
  bool open_shared();
  void open_own();
  void take_up();
  void close();

  std::filesystem::path file_, part_;
  int descriptor_ = -1;
  bool own_ = false;  // nobody else will find it
  std::uint64_t size_ = 0;
  Sha256 hash_;
};

}  // namespace tessera
