// SPDX-License-Identifier: Apache-2.0
// A file that appears whole or not at all: written under another name in the same folder, then renamed.
#pragma once

#include <filesystem>

namespace tessera {

class PendingFile {
 public:
  explicit PendingFile(std::filesystem::path file);
  PendingFile(const PendingFile&) = delete;
  PendingFile& operator=(const PendingFile&) = delete;
  // Removes what was written, unless it was committed.
  ~PendingFile();

  // `file`.tmp-…, different for every object, process and machine. Write this one, and close it.
  const std::filesystem::path& temporary() const { return temporary_; }
  // Renames it to `file`, replacing what was there. Throws std::filesystem::filesystem_error.
  void commit();

 private:
  std::filesystem::path file_, temporary_;
  bool committed_ = false;
};

}  // namespace tessera
