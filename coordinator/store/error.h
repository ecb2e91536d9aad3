// SPDX-License-Identifier: Apache-2.0
// What goes wrong with a store while it is used. What was stored before is as it was.
#pragma once

#include <filesystem>
#include <string_view>

#include "core/error.h"

namespace tessera {

// Reading or writing failed: nothing of what was to be written is there.
class StoreError : public Error {
 public:
  StoreError(const std::filesystem::path& where, std::string_view what,
             ExitCode code = ExitCode::internal_error)
      : Error(code, where.string() + ": " + std::string(what)) {}
};

// There is no room: on the disk, within a quota, or within the limit the store was given. The same may
// succeed later.
class StoreFull : public StoreError {
 public:
  using StoreError::StoreError;
};

// What is there is damaged.
class StoreDamaged : public StoreError {
 public:
  StoreDamaged(const std::filesystem::path& where, std::string_view what)
      : StoreError(where, what, ExitCode::bad_input) {}
};

}  // namespace tessera
