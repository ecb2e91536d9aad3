// SPDX-License-Identifier: Apache-2.0
#include "core/pending_file.h"

#include <fmt/format.h>

#include <random>
#include <system_error>

namespace tessera {

PendingFile::PendingFile(std::filesystem::path file) : file_(std::move(file)), temporary_(file_) {
  // Names need to differ, not to be repeatable: no picture depends on them.
  std::random_device random;
  temporary_ += fmt::format(".tmp-{:08x}{:08x}", random(), random());
}

PendingFile::~PendingFile() {
  if (committed_) return;
  std::error_code nothing_there;
  std::filesystem::remove(temporary_, nothing_there);
}

void PendingFile::commit() {
  std::filesystem::rename(temporary_, file_);
  committed_ = true;
}

}  // namespace tessera
