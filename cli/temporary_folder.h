// SPDX-License-Identifier: Apache-2.0
// A folder for files on their way, which vanishes with all that is in it.
#pragma once

#include <filesystem>
#include <string>

namespace tessera {

class TemporaryFolder {
 public:
  // In TMPDIR, else /tmp; nobody else may look into it. Throws InputError if it cannot be made.
  explicit TemporaryFolder(const std::string& word);
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  ~TemporaryFolder();

  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace tessera
