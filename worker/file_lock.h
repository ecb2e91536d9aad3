// SPDX-License-Identifier: Apache-2.0
// A lock on a file, between threads and processes; gone with its owner, however that ends.
#pragma once

#include <filesystem>
#include <memory>

namespace tessera {

class FileLock {
 public:
  // Makes the file, which may be removed by who holds it alone. Waits until nobody does. Throws
  // Error(internal_error) if it cannot be opened.
  static std::shared_ptr<FileLock> shared(const std::filesystem::path& file);
  // The same, but alone.
  static std::shared_ptr<FileLock> in_turn(const std::filesystem::path& file);
  // Null if somebody holds it: does not wait.
  static std::shared_ptr<FileLock> alone(const std::filesystem::path& file);

  FileLock(const FileLock&) = delete;
  FileLock& operator=(const FileLock&) = delete;
  ~FileLock();

 private:
  explicit FileLock(int descriptor) : descriptor_(descriptor) {}
  static std::shared_ptr<FileLock> take(const std::filesystem::path& file, int operation);
  static std::shared_ptr<FileLock> wait(const std::filesystem::path& file, int operation);

  int descriptor_;
};

}  // namespace tessera
