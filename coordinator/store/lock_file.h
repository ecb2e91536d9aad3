// SPDX-License-Identifier: Apache-2.0
// A file that one process at a time holds. It ends with the process, however that ends.
#pragma once

#include <filesystem>

namespace tessera {

class LockFile {
 public:
  // Throws Error(bad_usage) with the number of the process that has it.
  explicit LockFile(const std::filesystem::path& file);
  LockFile(const LockFile&) = delete;
  LockFile& operator=(const LockFile&) = delete;
  ~LockFile();

 private:
  int descriptor_;
};

}  // namespace tessera
