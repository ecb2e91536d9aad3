// SPDX-License-Identifier: Apache-2.0
// The tables of a store.
#pragma once

#include "coordinator/store/database.h"

namespace tessera {

inline constexpr int kStoreVersion = 1;

// Makes the tables if there are none. Throws StoreError (bad_input) for a database that is not a store's, or
// one of a later version.
void prepare_tables(Database& database);

}  // namespace tessera
