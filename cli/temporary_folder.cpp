// SPDX-License-Identifier: Apache-2.0
#include "cli/temporary_folder.h"

#include <stdlib.h>

#include "core/error.h"

namespace tessera {

TemporaryFolder::TemporaryFolder(const std::string& word) {
  std::error_code none;
  const std::filesystem::path place = std::filesystem::temp_directory_path(none);
  std::string name = ((none ? "/tmp" : place) / (word + "-XXXXXX")).string();
  if (mkdtemp(name.data()) == nullptr)
    throw InputError(name, "cannot be made", "a folder for temporary files, in TMPDIR");
  path_ = name;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code none;
  std::filesystem::remove_all(path_, none);
}

}  // namespace tessera
