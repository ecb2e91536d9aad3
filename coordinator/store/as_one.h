// SPDX-License-Identifier: Apache-2.0
// Statements that count together or not at all, as a transaction or as a step of the one under way.
#pragma once

#include <type_traits>

#include "coordinator/store/database.h"

namespace tessera {

template <class Work>
auto as_one(Database& database, const Work& work) {
  const bool outermost = !database.in_transaction();
  const auto begin = [&] { database.run(outermost ? "BEGIN IMMEDIATE" : "SAVEPOINT step"); };
  const auto end = [&] { database.run(outermost ? "COMMIT" : "RELEASE step"); };
  begin();
  try {
    if constexpr (std::is_void_v<decltype(work())>) {
      work();
      end();
    } else {
      auto result = work();
      end();
      return result;
    }
  } catch (...) {
    database.rollback(outermost);
    throw;
  }
}

}  // namespace tessera
